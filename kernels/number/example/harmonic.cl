// harmonic: sums 1 + 1/2 + 1/3 + ... in the format that the -D options choose, until a term no longer changes the sum.
// Launch it with one work-item.
#include "number/number.clh"

__kernel void harmonic(__global float* restrict sum,   // [1]
                       __global uint* restrict terms)  // [1], number of terms that changed the sum
{
    real last, next = num_const(0.0f);
    uint count = 0;
    do {
        last = next;
        ++count;
        next = num_add(last, num_div(num_const(1.0f), num_from_index(count)));
    } while (next != last);
    *sum = last;
    *terms = count - 1;
}
