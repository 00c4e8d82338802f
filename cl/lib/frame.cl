// Orthonormal frames. For one path or sixteen (lib/lanes.cl).

#include "lib/math.cl"

typedef struct {
    float3 s;
    float3 t;
    float3 n;
} frame_t;

// A frame about the unit vector n, without branches (Duff et al. 2017, "Building an Orthonormal Basis, Revisited", listing 3).
static inline frame_t frame_about(float3 n)
{
    float sign = sign_of(n.z);
    float a = -1.0f / (sign + n.z);
    float b = n.x * n.y * a;
    frame_t f;
    f.s = float3_of(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    f.t = float3_of(b, sign + n.y * n.y * a, -n.y);
    f.n = n;
    return f;
}

static inline float3 frame_to_local(const frame_t *f, float3 v)
{
    return float3_of(dot3(f->s, v), dot3(f->t, v), dot3(f->n, v));
}

static inline float3 frame_to_world(const frame_t *f, float3 v)
{
    return add3(add3(scale3(f->s, v.x), scale3(f->t, v.y)), scale3(f->n, v.z));
}
