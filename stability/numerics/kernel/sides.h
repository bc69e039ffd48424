/* What is called from outside: inverse iteration from both sides, and products of the parts. Vectors of numbers there
   have their imaginary parts beside the real ones.
*/

#include "numbers.h"
#include "factors.h"

/* f = B x, or f^T = x^T B from the left. */
static void NAME(multiply)(const Work *w, const number *weights, int left, const double *x, double *f)
{
    const Lines *p = w->p;
    const long flat = w->flat;
    memset(f, 0, PARTS * flat * sizeof(double));
    for (long line = p->first_line; line < p->lines; line++) {
        const number weight = less(zero, weights[p->part[line]]);
        double *row = f + p->row[line];
        if (left) {
            const number a = times(weight, get(x + p->row[line], flat));
            for (long e = p->start[line]; e < p->start[line + 1]; e++) {
                double *column = f + p->column[e];
                put(column, flat, add(get(column, flat), times(a, NAME(entry)(p, e))));
            }
        } else {
            number a = zero;
            for (long e = p->start[line]; e < p->start[line + 1]; e++)
                a = add(a, times(NAME(entry)(p, e), get(x + p->column[e], flat)));
            put(row, flat, add(get(row, flat), times(weight, a)));
        }
    }
}

/* Two inverse iterations of a vector with one factorisation; its last step, and the sizes of the steps and of it. */
static void NAME(iterate_side)(Work *w, const number *weights, int left, number *vector, number *step, double *sizes)
{
    const long count = w->p->interior + w->p->border, flat = w->flat;
    double **v = w->vector, squares[3] = {0, 0, 0};
    long largest = 0;
    for (long i = 0; i < count; i++) {
        put(v[0] + i, flat, vector[i]);
        if (size1(vector[i]) > size1(vector[largest]))
            largest = i;
    }
    NAME(scale)(count, v[0], flat, inverse(vector[largest]));
    for (int i = 0; i < 2; i++) {
        NAME(multiply)(w, weights, left, v[i], v[i + 1]);
        if (left)
            NAME(solve_left)(w, v[i + 1]);
        else
            NAME(solve)(w, v[i + 1]);
        NAME(scale)(count, v[i + 1], flat, inverse(get(v[i + 1] + largest, flat)));
    }
    for (long i = 0; i < count; i++) {
        const number before = get(v[1] + i, flat);
        vector[i] = get(v[2] + i, flat);
        step[i] = less(vector[i], before);
        squares[0] += square(less(before, get(v[0] + i, flat)));
        squares[1] += square(step[i]);
        squares[2] += square(vector[i]);
    }
    for (int i = 0; i < 3; i++)
        sizes[i] = sqrt(squares[i]);
}

/* At every point: factorise A - rate B and iterate from both sides, twice where two more iterations are about to make
   vectors right to `accuracy`.

   weights (points, parts), those of B times `rates` (points,) in the matrix; vectors (4, points, size) are x and y, which
   are changed, and then their last steps; sizes (points, 2, 3) are those of the steps and vectors of either side; flags
   (points,) are 1 where entries exceed `uneven` and 2 where the matrix is singular: there x and y stay as they are, and
   sizes are not numbers. Returns 0 where memory is lacking. */
EXPORT int NAME(iterate)(const Lines *p, long points, double uneven, double accuracy, const number *weights,
                         const number *rates, number *vectors, double *sizes, int *flags)
{
    Work work = {.memory = NULL}, *w = &work;
    const long count = p->interior + p->border, all_of_one = points * count;
    number *weighted = malloc(p->parts * sizeof(number));
    const int ready = NAME(prepare)(w, p) && weighted;
    for (long i = 0; i < 2 * all_of_one; i++)
        vectors[2 * all_of_one + i] = zero;
    for (long i = 0; i < 6 * points; i++)
        sizes[i] = NAN;
    for (long point = 0; ready && point < points; point++, weights += p->parts, vectors += count, sizes += 6) {
        for (long part = 0; part < p->parts; part++)
            weighted[part] = part < p->first_part ? weights[part] : times(weights[part], rates[point]);
        flags[point] = 0;
        if (NAME(assemble)(w, weighted) > uneven)
            flags[point] = 1;
        else if (!NAME(eliminate)(w) || !NAME(eliminate_bottom)(w) || !NAME(invert_corner)(w))
            flags[point] = 2;
        else
            for (int again = 0; again < 2 && (!again || nearly(sizes, accuracy)); again++)
                for (int left = 0; left < 2; left++)
                    NAME(iterate_side)(w, weights, left, vectors + left * all_of_one, vectors + (2 + left) * all_of_one,
                                       sizes + 3 * left);
    }
    free(weighted);
    free(w->memory);
    return ready;
}

/* y^T part x for every part: brackets (points, 3, parts) of x with y, of dx with y and of x with dy, and squares
   (points, parts), the sums of |y_i entry_ij x_j|^2; of the first alone where there are no steps dx and dy. Vectors are
   (points, size).

   Partial sums over BLOCK lines are summed: one sum over all lines would lose a digit to rounding at a large degree. */
EXPORT void NAME(brackets)(const Lines *p, long points, const number *x, const number *y, const number *dx,
                           const number *dy, number *brackets, double *squares)
{
    const long count = p->interior + p->border, kinds = dx ? 3 : 1;
    for (long point = 0; point < points; point++, x += count, y += count, brackets += kinds * p->parts) {
        memset(brackets, 0, kinds * p->parts * sizeof(number));
        if (dx)
            memset(squares, 0, p->parts * sizeof(double));
        for (long line = 0; line < p->lines;) {
            const long part = p->part[line];
            number block[3] = {zero, zero, zero};
            double sum = 0;
            do {
                const long row = p->row[line];
                number a = zero, b = zero;
                double c = 0;
                for (long e = p->start[line]; e < p->start[line + 1]; e++) {
                    const long column = p->column[e];
                    const number entry = NAME(entry)(p, e);
                    a = add(a, times(entry, x[column]));
                    if (dx) {
                        b = add(b, times(entry, dx[column]));
                        c += square(entry) * square(x[column]);
                    }
                }
                block[0] = add(block[0], times(y[row], a));
                if (dx) {
                    block[1] = add(block[1], times(y[row], b));
                    block[2] = add(block[2], times(dy[row], a));
                    sum += square(y[row]) * c;
                }
            } while (++line < p->lines && p->part[line] == part && line % BLOCK);
            for (long kind = 0; kind < kinds; kind++)
                brackets[kind * p->parts + part] = add(brackets[kind * p->parts + part], block[kind]);
            if (dx)
                squares[part] += sum;
        }
        if (dx)
            dx += count, dy += count, squares += p->parts;
    }
}

/* The rows beyond the truncation times x: tail (points, rows), for weights (points, parts) and x (points, size). */
EXPORT void NAME(beyond)(const Lines *p, long points, long rows, const number *weights, const number *x, number *tail)
{
    const long count = p->interior + p->border;
    for (long point = 0; point < points; point++, weights += p->parts, x += count, tail += rows) {
        memset(tail, 0, rows * sizeof(number));
        for (long line = 0; line < p->lines; line++) {
            number a = zero;
            for (long e = p->start[line]; e < p->start[line + 1]; e++)
                a = add(a, times(NAME(entry)(p, e), x[p->column[e]]));
            tail[p->row[line]] = add(tail[p->row[line]], times(weights[p->part[line]], a));
        }
    }
}

#undef number
#undef add
#undef less
#undef times
#undef inverse
#undef zero
#undef get
#undef put
#undef size1
#undef square
#undef subtract
#undef dot
#undef exchange
#undef Work
#undef PARTS
#undef BAND
#undef RIGHT
#undef LEFT
#undef BOTTOM
#undef CORNER
#undef INVERSE
#undef PIVOT
