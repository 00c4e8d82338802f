// Ray cones: how wide a patch of surface a path stands for, so that textures can be filtered over it (Amanatides 1984, "Ray Tracing with Cones";
// Akenine-Möller et al. 2021, "Improved Shader and Texture Level of Detail Using Ray Cones"). Curvature is left out: a mirror ball filters too little.

// The camera's cone covers so much of a pixel's width: the film's filter does the rest (docs/tradeoff.md has the measurement).
#define CONE_PIXELS 0.25f

// After a rough lobe a cone takes this share of the angle across the lobe that the direction stands for.
#define CONE_LOBE_SHARE 0.2f

typedef struct {
    float width;   // diameter at the ray's origin, metres
    float spread;  // growth of the diameter by distance
} cone_t;

// The spread after a direction that was drawn with density pdf over solid angle: a lobe of 1 / pdf steradians is about 2 / √(π pdf) across.
static inline float cone_spread_after(float spread, float pdf)
{
    return fmax(spread, CONE_LOBE_SHARE * 2.0f * rsqrt(M_PI_F * pdf));
}

// Area of the surface that a cone of diameter `width` covers: slanted by the cosine, of which no less than 0.01 counts. The square that a pixel is.
static inline float cone_footprint(float width, float cosine)
{
    return width * width / fmax(fabs(cosine), 0.01f);
}
