/* Threads of BLAS. The procedures are found by name at run time; the reference BLAS has none */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stddef.h>

/* Restrict BLAS to one thread: OpenBLAS, MKL and FlexiBLAS. An OpenBLAS with OpenMP takes the number
   of OpenMP at each call, whatever its own is. Parallel regions of the program state theirs */
void voussoir_set_one_blas_thread(void)
{
    static const char *const name[] = {"openblas_set_num_threads", "omp_set_num_threads",
                                       "MKL_Set_Num_Threads", "flexiblas_set_num_threads"};
    for (size_t i = 0; i < sizeof name / sizeof *name; ++i) {
        void (*set)(int);
        *(void **)&set = dlsym(RTLD_DEFAULT, name[i]);
        if (set) set(1);
    }
}

/* 1 if threads may call BLAS at the same time: an OpenBLAS built without threads has no locks */
int voussoir_blas_has_locks(void)
{
    int (*kind_of_threads)(void);
    *(void **)&kind_of_threads = dlsym(RTLD_DEFAULT, "openblas_get_parallel");
    return !kind_of_threads || kind_of_threads() != 0;
}
