// Marks to ranks: how many marks there are up to and with each. A work-item takes `span` of them; between the two kernels the host sums the sums.

KERNEL void count_marks(global const uint *marks, const uint count, const uint span, global uint *sums)
{
    uint begin = (uint)get_global_id(0) * span, sum = 0u;
    if (begin >= count)
        return;
    for (uint i = begin; i < begin + min(span, count - begin); i++)
        sum += marks[i];
    sums[get_global_id(0)] = sum;
}

KERNEL void rank_marks(global uint *marks, const uint count, const uint span, global const uint *before)
{
    uint begin = (uint)get_global_id(0) * span;
    if (begin >= count)
        return;
    uint sum = before[get_global_id(0)];
    for (uint i = begin; i < begin + min(span, count - begin); i++) {
        sum += marks[i];
        marks[i] = sum;
    }
}
