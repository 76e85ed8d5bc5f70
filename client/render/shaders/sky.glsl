// Linear light
const vec3 ZENITH = vec3(0.105, 0.235, 0.480);
const vec3 HORIZON = vec3(0.640, 0.740, 0.810);
const float HAZE_DEPTH = 0.028;  // sine of the angle below the horizon where 1/e of the haze is left
