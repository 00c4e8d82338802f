// Orthonormal frames.

typedef struct {
    float3 s;
    float3 t;
    float3 n;
} frame_t;

// A frame about the unit vector n, without branches (Duff et al. 2017, "Building an Orthonormal Basis, Revisited", listing 3).
static inline frame_t frame_about(float3 n)
{
    float sign = copysign(1.0f, n.z);
    float a = -1.0f / (sign + n.z);
    float b = n.x * n.y * a;
    frame_t f;
    f.s = (float3)(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    f.t = (float3)(b, sign + n.y * n.y * a, -n.y);
    f.n = n;
    return f;
}

// A frame about n whose s lies along the tangent as far as it can; without a usable tangent, any.
static inline frame_t frame_along(float3 n, float3 tangent)
{
    float3 s = tangent - n * dot(n, tangent);
    float length2 = dot(s, s);
    if (!(length2 > 1e-20f * dot(tangent, tangent)))
        return frame_about(n);
    frame_t f;
    f.s = s * rsqrt(length2);
    f.t = cross(n, f.s);
    f.n = n;
    return f;
}

static inline float3 frame_to_local(const frame_t *f, float3 v)
{
    return (float3)(dot(f->s, v), dot(f->t, v), dot(f->n, v));
}

static inline float3 frame_to_world(const frame_t *f, float3 v)
{
    return v.x * f->s + v.y * f->t + v.z * f->n;
}
