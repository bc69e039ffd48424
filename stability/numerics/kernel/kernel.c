/* Inverse iteration from both sides with bordered band matrices, compiled: sides.h says what it offers.

   No memory is kept between calls and nothing is shared: threads may call it at the same time.
*/
#include <float.h>
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

/* Whether vectors are less accurate than they shall be, and two more iterations would do: each shrinks the error by the
   ratio of the last steps. Sizes (2, 3) are those of the step before, of the last one and of the vector, of either side. */
static int nearly(const double *sizes, double accuracy)
{
    double now = 0, then = 0;
    for (const double *of = sizes; of < sizes + 6; of += 3) {
        const double shrinks = of[1] / fmax(fmax(of[0], of[1]), DBL_MIN), error = of[1] * shrinks / of[2];
        now = fmax(now, error);
        then = fmax(then, error * shrinks * shrinks);
    }
    return now >= accuracy && then < accuracy;
}

#define COMPLEX 0
#define NAME(name) name##_real
#include "sides.h"
#undef COMPLEX
#undef NAME
#define COMPLEX 1
#define NAME(name) name##_complex
#include "sides.h"
