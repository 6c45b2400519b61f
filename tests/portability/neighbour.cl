// Takes a number from the previous work-item twice, through local memory, and adds n between.
//   out    a number for each of 4 work-items; expected: n
__kernel void defect(__global uint *out, uint n) {
    const uint lid = get_local_id(0);
    __local uint passed[4];
    uint v = 0;
    passed[lid] = v;
    barrier(CLK_LOCAL_MEM_FENCE);
    v = passed[(lid + 3u) % 4u];
    barrier(CLK_LOCAL_MEM_FENCE);
    v += n;
    passed[lid] = v;
    barrier(CLK_LOCAL_MEM_FENCE);
    v = passed[(lid + 3u) % 4u];
    barrier(CLK_LOCAL_MEM_FENCE);
    out[lid] = v;
}
