// A plain list of triangles, each met by sixteen rays at once, a lane a ray, in place of eight triangles a ray as in accel/bvh8_block.cl; or by eight
// where that is what a register holds.
// lumiere/accel/flat16.py says what is in the array.
//
// The test is Möller & Trumbore's (1997, "Fast, Minimum Storage Ray/Triangle Intersection") with the bound of its roundings: lanes so near to an
// edge that they could be on either side, and NaN, go to the watertight test of shape/triangle_test.cl, one by one. Two triangles that are a parallelogram
// are met as one, p = v0 + u e1 + v e2 with u and v up to 1; the diagonal u = v parts them.

#include "accel/packet.cl"
#include "accel/template.cl"

static inline float_part absolute_part(float_part x)
{
    return as_float_part(as_int_part(x) & 0x7fffffff);
}

// Directions whose largest coordinate lies between 1/2 and 1, by the powers of two in `scale`.
typedef struct {
    float_part dx, dy, dz, scale;
} flat16_directions_t;

typedef struct {
    float_part u, v, height, size;  // of a hit: t is height / size, in lengths of the scaled direction; u and v are over size, too
    int_part doubt;                 // lanes that SHAPE_intersect has to decide
} flat16_test_t;

// Triangles that the row stands for: 2 for a parallelogram.
static inline uint flat16_triangles(global const float *plane)
{
    return plane[17] > 0.0f ? 2u : 1u;
}

static inline flat16_directions_t flat16_directions(const packet_t *packet, uint part)
{
    float_part x = absolute_part(packet->dx.part[part]), y = absolute_part(packet->dy.part[part]), z = absolute_part(packet->dz.part[part]);
    float_part largest = x > y ? x : y;
    largest = largest > z ? largest : z;
    int_part exponent = (as_int_part(largest) >> 23) & 255;  // biased by 127; that of the scale is 253 less it, short of what no float has
    exponent = exponent < 252 ? 253 - exponent : (int_part)(1);
    flat16_directions_t d;
    d.scale = as_float_part(exponent << 23);
    d.dx = packet->dx.part[part] * d.scale;
    d.dy = packet->dy.part[part] * d.scale;
    d.dz = packet->dz.part[part] * d.scale;
    return d;
}

// The lanes that may meet a triangle before height / size.
static inline int_part flat16_test(const packet_t *packet, uint part, const flat16_directions_t *d, global const float *plane, float_part height,
                                   float_part size, flat16_test_t *test)
{
    float_part cx = plane[0] - packet->ox.part[part], cy = plane[1] - packet->oy.part[part], cz = plane[2] - packet->oz.part[part];
    float_part rx = cy * d->dz - cz * d->dy, ry = cz * d->dx - cx * d->dz, rz = cx * d->dy - cy * d->dx;
    float_part u = rx * plane[6] + ry * plane[7] + rz * plane[8], v = -(rx * plane[3] + ry * plane[4] + rz * plane[5]);
    float_part determinant = d->dx * plane[9] + d->dy * plane[10] + d->dz * plane[11];
    float_part above = cx * plane[9] + cy * plane[10] + cz * plane[11];
    cx = absolute_part(cx);
    cy = absolute_part(cy);
    cz = absolute_part(cz);
    int_part sign = as_int_part(determinant) & (int)0x80000000;
    test->size = absolute_part(determinant);
    test->u = as_float_part(as_int_part(u) ^ sign);
    test->v = as_float_part(as_int_part(v) ^ sign);
    test->height = as_float_part(as_int_part(above) ^ sign);
    float_part w = test->size - (flat16_triangles(plane) == 2u ? (test->u > test->v ? test->u : test->v) : test->u + test->v);
    float_part least = test->u < test->v ? test->u : test->v;
    least = w < least ? w : least;
    float_part bound = (cx + cy + cz) * plane[15] + plane[16];
    // An origin whose height may be rounding lies in the plane (see triangle_intersect). The comparisons keep NaN.
    float_part in_plane = cx * plane[12] + cy * plane[13] + cz * plane[14];
    // Seen almost edge on, quotients are rounding, too.
    test->doubt = ~((least > bound) & (test->size > 256.0f * bound));
    return ~((least < -bound) | (test->height <= in_plane) | (test->height * size >= height * test->size));
}

static inline void SHAPE_FUNCTION(nearest_part)(const scene_t *scene, packet_t *packet, uint part)
{
    const flat16_directions_t d = flat16_directions(packet, part);
    float_part height = packet->t.part[part] / d.scale, size = (float_part)(1.0f), u = (float_part)(0.0f), v = (float_part)(0.0f);
    int_part index = (int_part)(-1);
    for (uint i = 0u, triangles; i < SHAPE_COUNT; i += triangles) {
        VISIT_PRIMITIVES(scene, packet->rays);
        flat16_test_t test;
        triangles = flat16_triangles(SHAPE_BUFFER(planes) + 20 * i);
        int_part met = flat16_test(packet, part, &d, SHAPE_BUFFER(planes) + 20 * i, height, size, &test), sure = met & ~test.doubt;
        height = sure ? test.height : height;
        size = sure ? test.size : size;
        index = sure ? (int_part)((int)i) : index;
        if (triangles == 2u) {
            // Of the first triangle, a, b, c, or the second, a, c, d, where (u, v) are along b − a and d − a.
            const int_part second = sure & (test.v > test.u);
            index = second ? (int_part)((int)i + 1) : index;
            const float_part other = test.v - test.u;
            test.u = second ? test.u : -other;
            test.v = second ? other : test.v;
        }
        u = sure ? test.u : u;
        v = sure ? test.v : v;
        if (!any_in_part(met & test.doubt))
            continue;
        // Seldom, and by copies, so that what is above stays in registers.
        each_float_t t, lane_u, lane_v;
        each_int_t doubt, decided;
        t.part[part] = height / size * d.scale;
        doubt.part[part] = met & test.doubt;
        decided.part[part] = index;
        for (uint lane = LANES_A_PART * part; lane < LANES_A_PART * (part + 1u); lane++) {
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
        height = doubt.part[part] ? t.part[part] / d.scale : height;
        size = doubt.part[part] ? (float_part)(1.0f) : size;
        u = doubt.part[part] ? lane_u.part[part] : u;
        v = doubt.part[part] ? lane_v.part[part] : v;
        index = decided.part[part];
    }
    packet->t.part[part] = index >= 0 ? height / size * d.scale : packet->t.part[part];
    packet->u.part[part] = index >= 0 ? u / size : packet->u.part[part];
    packet->v.part[part] = index >= 0 ? v / size : packet->v.part[part];
    packet->primitive.part[part] = index >= 0 ? as_uint_part(index) + SHAPE_FIRST : packet->primitive.part[part];
    packet->met.part[part] |= index >= 0;
}

static inline void SHAPE_FUNCTION(occluded_part)(const scene_t *scene, packet_t *packet, uint part)
{
    const flat16_directions_t d = flat16_directions(packet, part);
    const float_part t = packet->t_max.part[part] / d.scale;
    int_part blocked = (int_part)(0);
    for (uint i = 0u, triangles; i < SHAPE_COUNT; i += triangles) {
        VISIT_PRIMITIVES(scene, packet->rays);
        flat16_test_t test;
        triangles = flat16_triangles(SHAPE_BUFFER(planes) + 20 * i);
        int_part met = flat16_test(packet, part, &d, SHAPE_BUFFER(planes) + 20 * i, t, (float_part)(1.0f), &test) & ~blocked;
        blocked |= met & ~test.doubt;
        if (!any_in_part(met & test.doubt))
            continue;
        each_int_t doubt;
        doubt.part[part] = met & test.doubt;
        for (uint lane = LANES_A_PART * part; lane < LANES_A_PART * (part + 1u); lane++) {
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
        blocked |= doubt.part[part];
    }
    packet->met.part[part] |= blocked;
}

static inline void SHAPE_FUNCTION(nearest_packet)(const scene_t *scene, packet_t *packet)
{
    for (uint part = 0u; part < PARTS; part++)
        SHAPE_FUNCTION(nearest_part)(scene, packet, part);
}

static inline void SHAPE_FUNCTION(occluded_packet)(const scene_t *scene, packet_t *packet)
{
    for (uint part = 0u; part < PARTS; part++)
        SHAPE_FUNCTION(occluded_part)(scene, packet, part);
}
