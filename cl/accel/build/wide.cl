// The children of a wide node, when it is known which binary nodes are in it.

#include "accel/build/shares.cl"
#include "accel/build/tree.cl"

#define WIDTH 8u

// Those of the wide node that begins with a pair, as slots of binary nodes. Returns how many.
static inline uint wide_children(global const build_node_t *nodes, global const uint *shares, uint pair, uint *slots)
{
    uint allowed[WIDTH], count = 2u;
    slots[0] = 2u * pair;
    slots[1] = 2u * pair + 1u;
    allowed[0] = share_of(shares[pair], WIDTH);
    allowed[1] = WIDTH - allowed[0];
    for (uint i = 0u; i < count;) {
        uint link = nodes[slots[i]].link, share = link & LEAF ? 0u : share_of(shares[link], allowed[i]);
        if (share == 0u) {
            i++;
            continue;
        }
        slots[count] = 2u * link + 1u;
        allowed[count] = allowed[i] - share;
        count++;
        slots[i] = 2u * link;
        allowed[i] = share;
    }
    return count;
}
