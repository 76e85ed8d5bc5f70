// What is the same for the whole picture, on its way to the fragments.
layout(std140, binding = 0) uniform Source { ivec4 source_words[5]; };
layout(std140, binding = 1) uniform View { vec4 view_words[4]; };
flat out ivec4 source[5];
flat out vec4 view[4];

void pass_constants() {
    source = source_words;
    view = view_words;
}
