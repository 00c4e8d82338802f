// A plain list of triangles, each met by sixteen rays at once: a lane a ray, in place of eight triangles a ray as in accel/bvh8_block.cl.
// lumiere/accel/flat16.py says what is in the array.
//
// The test is Möller & Trumbore's (1997, "Fast, Minimum Storage Ray/Triangle Intersection") with the bound of its roundings: lanes so near to an
// edge that they could be on either side, and NaN, go to the watertight test of shape/triangle_test.cl, one by one. Two triangles that are a parallelogram
// are met as one, p = v0 + u e1 + v e2 with u and v up to 1; the diagonal u = v parts them.

#include "accel/packet.cl"
#include "accel/template.cl"

// Directions whose largest coordinate lies between 1/2 and 1, by the powers of two in `scale`.
typedef struct {
    float16 dx, dy, dz, scale;
} flat16_directions_t;

typedef struct {
    float16 u, v, height, size;  // of a hit: t is height / size, in lengths of the scaled direction; u and v are over size, too
    int16 doubt;                 // lanes that SHAPE_intersect has to decide
} flat16_test_t;

// Triangles that the row stands for: 2 for a parallelogram.
static inline uint flat16_triangles(global const float *plane)
{
    return plane[17] > 0.0f ? 2u : 1u;
}

static inline flat16_directions_t flat16_directions(const packet_t *packet)
{
    float16 x = absolute_lanes(packet->dx.all), y = absolute_lanes(packet->dy.all), z = absolute_lanes(packet->dz.all);
    float16 largest = x > y ? x : y;
    largest = largest > z ? largest : z;
    int16 exponent = (as_int16(largest) >> 23) & 255;  // biased by 127; that of the scale is 253 less it, short of what no float has
    exponent = exponent < 252 ? 253 - exponent : (int16)(1);
    flat16_directions_t d;
    d.scale = as_float16(exponent << 23);
    d.dx = packet->dx.all * d.scale;
    d.dy = packet->dy.all * d.scale;
    d.dz = packet->dz.all * d.scale;
    return d;
}

// The lanes that may meet a triangle before height / size.
static inline int16 flat16_test(const packet_t *packet, const flat16_directions_t *d, global const float *plane, float16 height, float16 size,
                                flat16_test_t *test)
{
    float16 cx = plane[0] - packet->ox.all, cy = plane[1] - packet->oy.all, cz = plane[2] - packet->oz.all;
    float16 rx = cy * d->dz - cz * d->dy, ry = cz * d->dx - cx * d->dz, rz = cx * d->dy - cy * d->dx;
    float16 u = rx * plane[6] + ry * plane[7] + rz * plane[8], v = -(rx * plane[3] + ry * plane[4] + rz * plane[5]);
    float16 determinant = d->dx * plane[9] + d->dy * plane[10] + d->dz * plane[11];
    float16 above = cx * plane[9] + cy * plane[10] + cz * plane[11];
    cx = absolute_lanes(cx);
    cy = absolute_lanes(cy);
    cz = absolute_lanes(cz);
    int16 sign = as_int16(determinant) & (int)0x80000000;
    test->size = absolute_lanes(determinant);
    test->u = as_float16(as_int16(u) ^ sign);
    test->v = as_float16(as_int16(v) ^ sign);
    test->height = as_float16(as_int16(above) ^ sign);
    float16 w = test->size - (flat16_triangles(plane) == 2u ? (test->u > test->v ? test->u : test->v) : test->u + test->v);
    float16 least = test->u < test->v ? test->u : test->v;
    least = w < least ? w : least;
    float16 bound = (cx + cy + cz) * plane[15] + plane[16];
    // An origin whose height may be rounding lies in the plane (see triangle_intersect). The comparisons keep NaN.
    float16 in_plane = cx * plane[12] + cy * plane[13] + cz * plane[14];
    // Seen almost edge on, quotients are rounding, too.
    test->doubt = ~((least > bound) & (test->size > 256.0f * bound));
    return ~((least < -bound) | (test->height <= in_plane) | (test->height * size >= height * test->size));
}

static inline void SHAPE_FUNCTION(nearest_packet)(const scene_t *scene, packet_t *packet)
{
    const flat16_directions_t d = flat16_directions(packet);
    float16 height = packet->t.all / d.scale, size = (float16)(1.0f), u = (float16)(0.0f), v = (float16)(0.0f);
    int16 index = (int16)(-1);
    for (uint i = 0u, triangles; i < SHAPE_COUNT; i += triangles) {
        VISIT_PRIMITIVES(scene, packet->rays);
        flat16_test_t test;
        triangles = flat16_triangles(SHAPE_BUFFER(planes) + 20 * i);
        int16 met = flat16_test(packet, &d, SHAPE_BUFFER(planes) + 20 * i, height, size, &test), sure = met & ~test.doubt;
        height = sure ? test.height : height;
        size = sure ? test.size : size;
        index = sure ? (int16)((int)i) : index;
        if (triangles == 2u) {
            // Of the first triangle, a, b, c, or the second, a, c, d, where (u, v) are along b − a and d − a.
            const int16 second = sure & (test.v > test.u);
            index = second ? (int16)((int)i + 1) : index;
            const float16 other = test.v - test.u;
            test.u = second ? test.u : -other;
            test.v = second ? other : test.v;
        }
        u = sure ? test.u : u;
        v = sure ? test.v : v;
        if (!any_lane(met & test.doubt))
            continue;
        // Seldom, and by copies, so that what is above stays in registers.
        each_float_t t, lane_u, lane_v;
        each_int_t doubt, decided;
        t.all = height / size * d.scale;
        doubt.all = met & test.doubt;
        decided.all = index;
        for (uint lane = 0u; lane < LANES; lane++) {
            if (!doubt.lane[lane])
                continue;
            const ray_t ray = packet_ray(packet, lane);
            const SHAPE_FUNCTION(ray_t) prepared = SHAPE_FUNCTION(prepare)(&ray);
            doubt.lane[lane] = 0;
            for (uint k = i; k < i + triangles; k++) {
                hit_t hit;
                if (SHAPE_FUNCTION(intersect)(scene, k, &ray, &prepared, t.lane[lane], &hit)) {
                    t.lane[lane] = hit.t;
                    lane_u.lane[lane] = hit.u;
                    lane_v.lane[lane] = hit.v;
                    decided.lane[lane] = (int)k;
                    doubt.lane[lane] = -1;
                }
            }
        }
        height = doubt.all ? t.all / d.scale : height;
        size = doubt.all ? (float16)(1.0f) : size;
        u = doubt.all ? lane_u.all : u;
        v = doubt.all ? lane_v.all : v;
        index = decided.all;
    }
    packet->t.all = index >= 0 ? height / size * d.scale : packet->t.all;
    packet->u.all = index >= 0 ? u / size : packet->u.all;
    packet->v.all = index >= 0 ? v / size : packet->v.all;
    packet->primitive.all = index >= 0 ? as_uint16(index) + SHAPE_FIRST : packet->primitive.all;
    packet->met.all |= index >= 0;
}

static inline void SHAPE_FUNCTION(occluded_packet)(const scene_t *scene, packet_t *packet)
{
    const flat16_directions_t d = flat16_directions(packet);
    const float16 t = packet->t_max.all / d.scale;
    int16 blocked = (int16)(0);
    for (uint i = 0u, triangles; i < SHAPE_COUNT; i += triangles) {
        VISIT_PRIMITIVES(scene, packet->rays);
        flat16_test_t test;
        triangles = flat16_triangles(SHAPE_BUFFER(planes) + 20 * i);
        int16 met = flat16_test(packet, &d, SHAPE_BUFFER(planes) + 20 * i, t, (float16)(1.0f), &test) & ~blocked;
        blocked |= met & ~test.doubt;
        if (!any_lane(met & test.doubt))
            continue;
        each_int_t doubt;
        doubt.all = met & test.doubt;
        for (uint lane = 0u; lane < LANES; lane++) {
            if (!doubt.lane[lane])
                continue;
            const ray_t ray = packet_ray(packet, lane);
            const SHAPE_FUNCTION(ray_t) prepared = SHAPE_FUNCTION(prepare)(&ray);
            doubt.lane[lane] = 0;
            for (uint k = i; k < i + triangles; k++) {
                hit_t hit;
                doubt.lane[lane] |= SHAPE_FUNCTION(intersect)(scene, k, &ray, &prepared, ray.t_max, &hit) ? -1 : 0;
            }
        }
        blocked |= doubt.all;
    }
    packet->met.all |= blocked;
}
