// The camera, of whatever it sees. In the vertex shader, the uniform block of constants.vert.
#ifdef VERTEX
#define view view_words
#else
flat in vec4 view[4];
#endif
#define forward view[0].xyz
#define right view[1].xyz     // a pixel's width, at depth 1
#define up view[2].xyz        // a pixel's height, at depth 1
#define least_depth view[1].w // nothing is nearer than this
#define picture view[3].xy    // pixels
#define height view[3].z      // what haze is measured by: of the eye above a plane
#define haze view[3].w

// Linear light
const vec3 ZENITH = vec3(0.105, 0.235, 0.480);
const vec3 HORIZON = vec3(0.640, 0.740, 0.810);
const float HAZE_DEPTH = 0.028;  // heights over distance, where 1/e of the haze is left

// Of a place of the picture, counted from its middle, y up; per unit of depth
vec3 ray_through(vec2 place) { return forward + place.x * right + place.y * up; }
