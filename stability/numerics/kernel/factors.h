/* LU factors of a bordered band matrix, and solutions from either side. */

/* Factors of   [ band    right  ]  =  [ L        ] [ U  right'  ]
                [ bottom  corner ]     [ bottom' 1 ] [    corner' ]

   Row r of the band begins with column r - lower; `left` holds the columns of L below the diagonal, `pivot` the inverse
   diagonal of U. `reach` is the last column of a row, `swap` what row k was exchanged with when its turn came. Behind
   `corner` there is room for the inverse of corner'; `edge` is for the border of a vector. */
#define Work NAME(Work)
typedef struct {
    const Lines *p;
    long width, side, deep, flat; /* gaps of rows of band, right and left, and of vectors and rows of the bottom */
    double *band, *right, *left, *bottom, *corner, *pivot, *vector[3], *edge;
    int *reach, *swap;
    void *memory;
} Work;

#define BAND(row, column) (w->band + (row) * PARTS * w->width + (column) - (row) + w->p->lower)
#define RIGHT(row) (w->right + (row) * PARTS * w->side)
#define LEFT(column) (w->left + (column) * PARTS * w->deep)
#define BOTTOM(row) (w->bottom + (row) * PARTS * w->flat)
#define CORNER(row) (w->corner + (row) * PARTS * w->side)
#define INVERSE(row) CORNER(w->p->border + (row))
#define PIVOT(row) get(w->pivot + (row), w->p->interior)

static int NAME(prepare)(Work *w, const Lines *p)
{
    const long n = p->interior, m = p->border;
    w->p = p;
    w->width = 2 * p->lower + p->upper + 1 + LANES;
    w->side = (m + LANES) / LANES * LANES;
    w->deep = (p->lower + LANES) / LANES * LANES;
    w->flat = n + m + p->lower + 2 * LANES;
    const long sizes[] = {n * w->width, n * w->side, n * w->deep, m * w->flat, 2 * m * w->side, n,
                          w->flat, w->flat, w->flat, w->flat};
    double **places[] = {&w->band, &w->right, &w->left, &w->bottom, &w->corner, &w->pivot, w->vector, w->vector + 1,
                         w->vector + 2, &w->edge};
    long room = n + 1; /* for reach and swap */
    for (int i = 0; i < 10; i++)
        room += PARTS * sizes[i];
    w->memory = malloc(room * sizeof(double));
    if (!w->memory)
        return 0;
    double *next = w->memory;
    for (int i = 0; i < 10; next += PARTS * sizes[i], i++)
        *places[i] = next;
    w->reach = (int *)next;
    w->swap = w->reach + n;
    memset(w->left, 0, PARTS * n * w->deep * sizeof(double));
    memset(w->edge, 0, PARTS * w->flat * sizeof(double));
    return 1;
}

/* The largest modulus from x to end; four are sought at once, since each waits for the one before. */
static double NAME(largest)(const double *x, const double *end)
{
    double found[4] = {0, 0, 0, 0};
    for (; x + 4 <= end; x += 4)
        for (int i = 0; i < 4; i++)
            found[i] = fabs(x[i]) > found[i] ? fabs(x[i]) : found[i];
    for (; x < end; x++)
        found[0] = fabs(*x) > found[0] ? fabs(*x) : found[0];
    return fmax(fmax(found[0], found[1]), fmax(found[2], found[3]));
}

/* Set the matrix to the sum of the parts times weights; return its largest entry. */
static double NAME(assemble)(Work *w, const number *weights)
{
    const Lines *p = w->p;
    const long n = p->interior;
    memset(w->band, 0, PARTS * n * (w->width + w->side) * sizeof(double)); /* and what is right of it */
    memset(w->bottom, 0, PARTS * p->border * w->flat * sizeof(double));
    memset(w->reach, 0, n * sizeof(int));
    for (long line = 0; line < p->lines; line++) {
        const number weight = weights[p->part[line]];
        const long row = p->row[line];
        for (long e = p->start[line]; e < p->start[line + 1]; e++) {
            const long column = p->column[e];
            long gap = w->flat;
            double *place;
            if (row >= n)
                place = BOTTOM(row - n) + column;
            else if (column >= n)
                place = RIGHT(row) + column - n, gap = w->side;
            else {
                place = BAND(row, column), gap = w->width;
                if (column > w->reach[row])
                    w->reach[row] = column;
            }
            put(place, gap, add(get(place, gap), times(weight, NAME(entry)(p, e))));
        }
    }
    return fmax(NAME(largest)(w->band, w->left), NAME(largest)(w->bottom, w->corner));
}

/* Eliminate the band with row exchanges (LAPACK's gbtrf does the same); return whether no pivot vanishes. */
static int NAME(eliminate)(Work *w)
{
    const Lines *p = w->p;
    const long n = p->interior, m = p->border;
    for (long k = 0; k < n; k++) {
        const long last = k + p->lower < n - 1 ? k + p->lower : n - 1;
        long best = k;
        double most = -1;
        for (long r = k; r <= last; r++) {
            const double size = size1(get(BAND(r, k), w->width));
            if (size > most)
                most = size, best = r;
        }
        if (most == 0)
            return 0;
        w->swap[k] = best;
        if (best != k) {
            const int reach = w->reach[best];
            w->reach[best] = w->reach[k];
            w->reach[k] = reach;
            exchange((reach > w->reach[best] ? reach : w->reach[best]) - k + 1, BAND(k, k), w->width, BAND(best, k),
                     w->width);
            exchange(m, RIGHT(k), w->side, RIGHT(best), w->side);
        }
        const number pivot = inverse(get(BAND(k, k), w->width));
        put(w->pivot + k, n, pivot);
        for (long r = k + 1; r <= last; r++) {
            const number factor = times(get(BAND(r, k), w->width), pivot);
            put(LEFT(k) + r - k - 1, w->deep, factor);
            if (size1(factor) == 0)
                continue;
            subtract(w->reach[k] - k, factor, BAND(k, k + 1), w->width, BAND(r, k + 1), w->width);
            subtract(m, factor, RIGHT(k), w->side, RIGHT(r), w->side);
            if (w->reach[k] > w->reach[r])
                w->reach[r] = w->reach[k];
        }
    }
    return 1;
}

/* Eliminate the rows below the band: `corner` becomes what is left of theirs beside it. Always succeeds. */
static int NAME(eliminate_bottom)(Work *w)
{
    const long n = w->p->interior, m = w->p->border;
    memset(w->corner, 0, 2 * PARTS * m * w->side * sizeof(double));
    for (long j = 0; j < m; j++) {
        double *row = BOTTOM(j);
        for (long k = 0; k < n; k++) {
            const number factor = times(get(row + k, w->flat), PIVOT(k));
            put(row + k, w->flat, factor);
            if (size1(factor) == 0)
                continue;
            subtract(w->reach[k] - k, factor, BAND(k, k + 1), w->width, row + k + 1, w->flat);
            subtract(m, factor, RIGHT(k), w->side, row + n, w->flat);
        }
        for (long i = 0; i < m; i++) { /* loops over what is below the band run on into this: it must be 0 */
            put(CORNER(j) + i, w->side, get(row + n + i, w->flat));
            put(row + n + i, w->flat, zero);
        }
    }
    return 1;
}

/* Turn `corner` into the identity, and that into its inverse (Gauss and Jordan); return whether it exists. */
static int NAME(invert_corner)(Work *w)
{
    const long m = w->p->border, side = w->side;
    for (long k = 0; k < m; k++)
        INVERSE(k)[k] = 1;
    for (long k = 0; k < m; k++) {
        long best = k;
        for (long j = k + 1; j < m; j++)
            if (size1(get(CORNER(j) + k, side)) > size1(get(CORNER(best) + k, side)))
                best = j;
        if (size1(get(CORNER(best) + k, side)) == 0)
            return 0;
        exchange(m, CORNER(k), side, CORNER(best), side);
        exchange(m, INVERSE(k), side, INVERSE(best), side);
        const number pivot = inverse(get(CORNER(k) + k, side));
        NAME(scale)(m, CORNER(k), side, pivot);
        NAME(scale)(m, INVERSE(k), side, pivot);
        for (long j = 0; j < m; j++) {
            const number factor = get(CORNER(j) + k, side);
            if (j == k)
                continue;
            subtract(m, factor, CORNER(k), side, CORNER(j), side);
            subtract(m, factor, INVERSE(k), side, INVERSE(j), side);
        }
    }
    return 1;
}

/* Put z with M z = f in the place of f. */
static void NAME(solve)(const Work *w, double *f)
{
    const Lines *p = w->p;
    const long n = p->interior, m = p->border, flat = w->flat;
    double *g = w->edge;
    for (long k = 0; k < n; k++) {
        const number a = get(f + w->swap[k], flat);
        put(f + w->swap[k], flat, get(f + k, flat));
        put(f + k, flat, a);
        subtract(p->lower, a, LEFT(k), w->deep, f + k + 1, flat);
    }
    for (long j = 0; j < m; j++) /* what L and bottom' leave of the border, then its solution */
        put(g + j, flat, less(get(f + n + j, flat), dot(n, BOTTOM(j), flat, f, flat)));
    for (long j = 0; j < m; j++)
        put(f + n + j, flat, dot(m, INVERSE(j), w->side, g, flat));
    for (long k = n - 1; k >= 0; k--) {
        number a = less(get(f + k, flat), dot(m, RIGHT(k), w->side, f + n, flat));
        a = less(a, dot(w->reach[k] - k, BAND(k, k + 1), w->width, f + k + 1, flat));
        put(f + k, flat, times(a, PIVOT(k)));
    }
}

/* Put z with z^T M = g^T in the place of g. */
static void NAME(solve_left)(const Work *w, double *g)
{
    const Lines *p = w->p;
    const long n = p->interior, m = p->border, flat = w->flat;
    double *h = w->edge;
    for (long k = 0; k < n; k++) {
        const number a = times(get(g + k, flat), PIVOT(k));
        put(g + k, flat, a);
        subtract(w->reach[k] - k, a, BAND(k, k + 1), w->width, g + k + 1, flat);
        subtract(m, a, RIGHT(k), w->side, g + n, flat);
    }
    for (long j = 0; j < m; j++) {
        put(h + j, flat, get(g + n + j, flat));
        put(g + n + j, flat, zero);
    }
    for (long j = 0; j < m; j++)
        subtract(m, less(zero, get(h + j, flat)), INVERSE(j), w->side, g + n, flat);
    for (long j = 0; j < m; j++)
        subtract(n, get(g + n + j, flat), BOTTOM(j), flat, g, flat);
    for (long k = n - 1; k >= 0; k--) {
        const number a = less(get(g + k, flat), dot(p->lower, LEFT(k), w->deep, g + k + 1, flat));
        put(g + k, flat, get(g + w->swap[k], flat));
        put(g + w->swap[k], flat, a);
    }
}

