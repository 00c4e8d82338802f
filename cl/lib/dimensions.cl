// The dimensions of a path's random numbers: those of the vertex at `depth` are (depth + 1) × DIMENSIONS_A_VERTEX + one of these, and the camera is the
// vertex before the first.

#define DIMENSIONS_A_VERTEX 8u
#define DIMENSION_LIGHT 0u      // which light, and where on it
#define DIMENSION_LOBE 2u       // which lobe of the BSDF
#define DIMENSION_BSDF 3u       // which direction
#define DIMENSION_ROULETTE 4u
#define DIMENSION_MIX 5u        // which part of a mix
// Of a step of the walk in a body, whose sequence is its own (lib/walk.cl); the first flight is on the surface's.
#define DIMENSION_PHASE DIMENSION_BSDF
#define DIMENSION_STEP_ROULETTE DIMENSION_ROULETTE
#define DIMENSION_FLIGHT 6u     // channel and distance
// Of the camera.
#define DIMENSION_LENS 0u
#define DIMENSION_WAVELENGTH 2u // of each channel, where glass disperses (lib/dispersion.cl)
#define DIMENSION_FILM DIMENSION_BSDF
