// The array of lumiere/accel/cwbvh.py, and the primitives in the order that has those of a node's leaves together, a wide node at a time.

#include "accel/build/wide.cl"

// Values on one axis as multiples of a power of two, from the node's corner on.
typedef struct {
    float corner;
    float unit;  // half of everything, where differences else overflow
    uint exponent;  // of the grid's step, biased
    float per_step;
} cwbvh_axis_t;

static inline cwbvh_axis_t cwbvh_axis(float low, float high)
{
    cwbvh_axis_t axis;
    axis.corner = low;
    axis.unit = max(fabs(low), fabs(high)) > 0x1p126f ? 0.5f : 1.0f;
    uint exponent = as_uint((high * axis.unit - low * axis.unit) / 255.0f) >> 23;
    axis.exponent = clamp(exponent + (axis.unit < 1.0f ? 2u : 1u), 1u, 248u);
    axis.per_step = as_float((254u - axis.exponent) << 23) / axis.unit;
    return axis;
}

// The last step of the grid at or before a value, or with `up` the first at or after it.
static inline uint cwbvh_steps(const cwbvh_axis_t *axis, float value, bool up)
{
    // A rounded difference and, exactly, what it lacks (Knuth, "The Art of Computer Programming", volume 2, section 4.2.2, theorem B).
    float a = value * axis->unit, b = axis->corner * axis->unit, difference = a - b;
    float b_part = a - difference, a_part = difference + b_part, lacks = (b_part - b) + (a - a_part);
    float steps = difference * axis->per_step, whole = up ? ceil(steps) : floor(steps);
    if (whole == steps)
        whole += up ? (lacks > 0.0f ? 1.0f : 0.0f) : (lacks < 0.0f ? -1.0f : 0.0f);
    return (uint)clamp(whole, 0.0f, 255.0f);
}

static inline void cwbvh_put(uint *words, uint byte, uint value)
{
    words[byte / 4u] |= value << 8u * (byte % 4u);
}

KERNEL void encode_cwbvh(global const build_node_t *nodes, global const uint *arranged, global const uint *inner_sums, global const uint *leaf_sums,
                         global const uint *numbers, global const uint *order, const uint count, const uint span, global uint *encoded,
                         global uint *new_order)
{
    uint begin = (uint)get_global_id(0) * span;
    if (begin >= count)
        return;
    for (uint wide = begin; wide < begin + min(span, count - begin); wide++) {
        global const uint *slots = arranged + WIDTH * (size_t)wide;
        float8 whole = box_nothing();
        for (uint slot = 0u; slot < WIDTH; slot++)
            if (slots[slot] != 0u)
                whole = box_join(whole, node_box(nodes + slots[slot]));
        cwbvh_axis_t axes[3] = {cwbvh_axis(whole.s0, -whole.s4), cwbvh_axis(whole.s1, -whole.s5), cwbvh_axis(whole.s2, -whole.s6)};
        uint words[20] = {0u};
        uint first = wide > 0u ? leaf_sums[wide - 1u] : 0u, place = 0u;
        for (uint axis = 0u; axis < 3u; axis++) {
            words[axis] = as_uint(axes[axis].corner);
            cwbvh_put(words, 12u + axis, axes[axis].exponent);
        }
        words[4] = 1u + (wide > 0u ? inner_sums[wide - 1u] : 0u);
        words[5] = first;
        for (uint slot = 0u; slot < WIDTH; slot++) {
            if (slots[slot] == 0u)
                continue;
            build_node_t child = nodes[slots[slot]];
            for (uint axis = 0u; axis < 3u; axis++) {
                cwbvh_put(words, 32u + 8u * axis + slot, cwbvh_steps(&axes[axis], child.low[axis], false));
                cwbvh_put(words, 56u + 8u * axis + slot, cwbvh_steps(&axes[axis], child.high[axis], true));
            }
            if (child.link & LEAF) {
                uint members = child.link & ~LEAF;
                cwbvh_put(words, 24u + slot, ((1u << members) - 1u) << 5 | place);
                for (uint i = 0u; i < members; i++)
                    new_order[first + place + i] = order[child.first + i];
                place += members;
            } else {
                cwbvh_put(words, 15u, 1u << slot);
                cwbvh_put(words, 24u + slot, 1u << 5 | (24u + slot));
            }
        }
        for (uint word = 0u; word < 20u; word++)
            encoded[20u * (size_t)numbers[wide] + word] = words[word];
    }
}
