// Of the children of a wide node that a binary node may stand for, 1 to 8, how many its left child should; 0: it stands as one child. As the host's
// _shares (lumiere/accel/bvh8.py), by a node's pair: three bits each from 2 on.

static inline uint share_of(uint shares, uint allowed)
{
    return allowed < 2u ? 0u : shares >> 3u * (allowed - 2u) & 7u;
}
