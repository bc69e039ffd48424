/* Numbers and vectors, complex or real: COMPLEX is 1 or 0, NAME(name) a name for the kind.

   A vector lies in memory as its real parts followed, `gap` numbers later, by its imaginary parts. Loops run LANES
   numbers at a time and so up to LANES - 1 too far: behind every vector there is room, and nothing but zeros in what is
   added there.
*/

#define number NAME(number)
#define add NAME(add)
#define less NAME(less)
#define zero NAME(zero)
#define times NAME(times)
#define inverse NAME(inverse)
#define get NAME(get)
#define put NAME(put)
#define size1 NAME(size1)
#define square NAME(square)
#define subtract NAME(subtract)
#define dot NAME(dot)
#define exchange NAME(exchange)
#define PARTS (1 + COMPLEX) /* of a number */

#if COMPLEX
typedef struct { double re, im; } number;
static inline number add(number a, number b) { return (number){a.re + b.re, a.im + b.im}; }
static inline number less(number a, number b) { return (number){a.re - b.re, a.im - b.im}; }
static inline number times(number a, number b)
{
    return (number){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
static inline number get(const double *x, long gap) { return (number){x[0], x[gap]}; }
static inline void put(double *x, long gap, number a) { x[0] = a.re; x[gap] = a.im; }
static inline double size1(number a) { return fabs(a.re) + fabs(a.im); }
static inline double square(number a) { return a.re * a.re + a.im * a.im; }
static const number zero = {0, 0};
static inline number NAME(entry)(const Lines *p, long e) { return (number){p->re[e], p->im[e]}; }
static inline number inverse(number a)
{
    const double s = 1 / size1(a), re = a.re * s, im = a.im * s, t = s / (re * re + im * im);
    return (number){re * t, -im * t};
}
#else
typedef double number;
static inline number add(number a, number b) { return a + b; }
static inline number less(number a, number b) { return a - b; }
static inline number times(number a, number b) { return a * b; }
static inline number get(const double *x, long gap) { return x[0]; }
static inline void put(double *x, long gap, number a) { x[0] = a; }
static inline double size1(number a) { return fabs(a); }
static inline double square(number a) { return a * a; }
static const number zero = 0;
static inline number NAME(entry)(const Lines *p, long e) { return p->re[e]; }
static inline number inverse(number a) { return 1 / a; }
#endif

/* y -= a x */
static inline void subtract(long count, number a, const double *x, long x_gap, double *y, long y_gap)
{
#if COMPLEX
    const lanes re = all(a.re), im = all(a.im);
    for (long i = 0; i < count; i += LANES) {
        const lanes xr = load(x + i), xi = load(x + x_gap + i);
        store(y + i, load(y + i) - re * xr + im * xi);
        store(y + y_gap + i, load(y + y_gap + i) - re * xi - im * xr);
    }
#else
    for (long i = 0; i < count; i += LANES)
        store(y + i, load(y + i) - all(a) * load(x + i));
#endif
}

/* the sum of x y */
static inline number dot(long count, const double *x, long x_gap, const double *y, long y_gap)
{
    lanes re = all(0);
#if COMPLEX
    lanes im = all(0);
    for (long i = 0; i < count; i += LANES) {
        const lanes xr = load(x + i), xi = load(x + x_gap + i), yr = load(y + i), yi = load(y + y_gap + i);
        re += xr * yr - xi * yi;
        im += xr * yi + xi * yr;
    }
    return (number){total(re), total(im)};
#else
    for (long i = 0; i < count; i += LANES)
        re += load(x + i) * load(y + i);
    return total(re);
#endif
}

static inline void exchange(long count, double *x, long x_gap, double *y, long y_gap)
{
    for (int part = 0; part < PARTS; part++, x += x_gap, y += y_gap)
        for (long i = 0; i < count; i += LANES) {
            const lanes kept = load(x + i);
            store(x + i, load(y + i));
            store(y + i, kept);
        }
}

static inline void NAME(scale)(long count, double *x, long gap, number factor)
{
    for (long i = 0; i < count; i++)
        put(x + i, gap, times(factor, get(x + i, gap)));
}

