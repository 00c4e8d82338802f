// Vectors by components, and what is made of single numbers: for one path or sixteen (lib/lanes.cl).

static inline float2 float2_of(float x, float y)
{
    float2 v;
    v.x = x;
    v.y = y;
    return v;
}

static inline float3 float3_of(float x, float y, float z)
{
    float3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}

static inline float3 add3(float3 a, float3 b)
{
    return float3_of(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline float3 subtract3(float3 a, float3 b)
{
    return float3_of(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline float3 multiply3(float3 a, float3 b)
{
    return float3_of(a.x * b.x, a.y * b.y, a.z * b.z);
}

static inline float3 scale3(float3 v, float scale)
{
    return float3_of(v.x * scale, v.y * scale, v.z * scale);
}

static inline float dot3(float3 a, float3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline float3 cross3(float3 a, float3 b)
{
    return float3_of(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

// By bits: fabs is a call on some runtimes.
static inline float absolute(float x)
{
    return as_float(as_int(x) & 0x7fffffff);
}

// 1 or −1.
static inline float sign_of(float x)
{
    return as_float((as_int(x) & (int)0x80000000) | 0x3f800000);
}

static inline float3 absolute3(float3 v)
{
    return float3_of(absolute(v.x), absolute(v.y), absolute(v.z));
}

// By bits without the sign, among which infinity is 0xff000000: isfinite is a call on some runtimes, across which no vector stays in a register.
static inline bool is_finite(float x)
{
    return (as_uint(x) << 1) < 0xff000000u;
}

static inline float larger(float a, float b)
{
    return a > b ? a : b;
}

static inline float3 unit3(float3 v)
{
    return scale3(v, 1.0f / sqrt(dot3(v, v)));
}

static inline bool is_black(float3 c)
{
    return c.x == 0.0f && c.y == 0.0f && c.z == 0.0f;
}

// Unit interval from 32 random bits: the 24 that a float holds, below 1.
static inline float unit_float(uint bits)
{
    return convert_float(bits >> 8) * 0x1p-24f;
}
