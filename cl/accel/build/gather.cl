// Records of `words` words each into the order of the leaves. One work-item takes `span` of them.

KERNEL void gather(global const uint *records, global const uint *order, const uint words, const uint count, const uint span, global uint *ordered)
{
    uint begin = (uint)get_global_id(0) * span;
    if (begin >= count)
        return;
    for (uint i = begin; i < begin + min(span, count - begin); i++) {
        global const uint *from = records + words * (size_t)order[i];
        global uint *to = ordered + words * (size_t)i;
        for (uint word = 0u; word < words; word++)
            to[word] = from[word];
    }
}
