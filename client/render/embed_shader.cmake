# cmake -DINPUT=plane.frag -DOUTPUT=plane_frag.h -DNAME=plane_frag -P embed_shader.cmake
file(READ ${INPUT} text)
file(WRITE ${OUTPUT} "#pragma once\n\ninline constexpr char ${NAME}_source[] = R\"glsl(${text})glsl\";\n")
