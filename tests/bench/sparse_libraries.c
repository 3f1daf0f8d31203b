/* Sparse Cholesky factors of CHOLMOD and MUMPS for sparse_bench: analysis, factor, solution */
#include <dmumps_c.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>

/* Messages: MUMPS has four streams and a level of output */
enum { n_streams = 4, use_comm_world = -987654 };

typedef struct {
    cholmod_common common;
    cholmod_sparse *matrix;
    cholmod_factor *factor;
    DMUMPS_STRUC_C mumps;
} sparse_t;

static void call_mumps(sparse_t *s, int job)
{
    s->mumps.job = job;
    dmumps_c(&s->mumps);
    if (s->mumps.infog[0] < 0) abort();
}

/* The lower triangle of a symmetric matrix: rows and columns from one on */
void *sparse_open(int n, int n_entry, int *row, int *column, double *value)
{
    sparse_t *s = calloc(1, sizeof *s);
    cholmod_start(&s->common);
    cholmod_triplet *entries = cholmod_allocate_triplet(n, n, n_entry, -1, CHOLMOD_REAL, &s->common);
    entries->nnz = n_entry;
    memcpy(entries->x, value, n_entry * sizeof *value);
    for (int i = 0; i < n_entry; ++i) {
        ((int *)entries->i)[i] = row[i] - 1;
        ((int *)entries->j)[i] = column[i] - 1;
    }
    s->matrix = cholmod_triplet_to_sparse(entries, n_entry, &s->common);
    cholmod_free_triplet(&entries, &s->common);
    s->mumps.par = 1;
    s->mumps.sym = 1;
    s->mumps.comm_fortran = use_comm_world;
    call_mumps(s, -1);
    for (int i = 0; i < n_streams; ++i) s->mumps.icntl[i] = 0;
    s->mumps.n = n;
    s->mumps.nz = n_entry;
    s->mumps.irn = row;
    s->mumps.jcn = column;
    s->mumps.a = value;
    return s;
}

/* Work 1: analysis, 2: factor, 3: solution, from the right-hand side in x */
void cholmod_work(sparse_t *s, int work, double *x)
{
    if (work == 1) {
        cholmod_free_factor(&s->factor, &s->common);
        s->factor = cholmod_analyze(s->matrix, &s->common);
    } else if (work == 2) {
        cholmod_factorize(s->matrix, s->factor, &s->common);
    } else {
        cholmod_dense load = {.nrow = s->matrix->nrow, .ncol = 1, .nzmax = s->matrix->nrow,
                              .d = s->matrix->nrow, .x = x, .xtype = CHOLMOD_REAL};
        cholmod_dense *solution = cholmod_solve(CHOLMOD_A, s->factor, &load, &s->common);
        memcpy(x, solution->x, s->matrix->nrow * sizeof *x);
        cholmod_free_dense(&solution, &s->common);
    }
    if (s->common.status != CHOLMOD_OK) abort();
}

/* The same */
void mumps_work(sparse_t *s, int work, double *x)
{
    s->mumps.rhs = x;
    call_mumps(s, work);
}

void sparse_close(sparse_t *s)
{
    call_mumps(s, -2);
    cholmod_free_factor(&s->factor, &s->common);
    cholmod_free_sparse(&s->matrix, &s->common);
    cholmod_finish(&s->common);
    free(s);
}
