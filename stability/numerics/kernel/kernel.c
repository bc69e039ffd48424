/* Inverse iteration from both sides with bordered band matrices, compiled: sides.h says what it offers.

   No memory is kept between calls and nothing is shared: threads may call it at the same time.
*/
#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define BLOCK 24 /* lines that are summed on their own, as in stack.py */

/* Numbers that are worked on at once, by every processor in the same order; in memory they begin anywhere. */
#define LANES 2
#define all(value) ((lanes){(value), (value)})
#define total(x) ((x)[0] + (x)[1])
typedef double lanes __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
#define load(place) (*(const lanes *)(place))
#define store(place, value) (*(lanes *)(place) = (value))

/* Sums of sparse matrices times scalars: a line for every row of every one of the `parts` that is not empty.

   Entries start[line] .. start[line + 1] - 1 of a line of `part` and `row` are re + i im in `column`.
   Lines from first_line on belong to the parts from first_part on: those of -B. */
typedef struct {
    long interior, border, lower, upper, parts, first_part, lines, first_line;
    const int *part, *row, *start, *column;
    const double *re, *im;
} Lines;

#define COMPLEX 0
#define NAME(name) name##_real
#include "sides.h"
#undef COMPLEX
#undef NAME
#define COMPLEX 1
#define NAME(name) name##_complex
#include "sides.h"
