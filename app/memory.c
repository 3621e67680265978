// Memory of the program, and of its libraries: a request that cannot be met ends the program with a message. gfortran does
// not check memory for values such as `[list, more]`, and goes on with a null pointer; HDF5 goes on with other bytes.

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)

#define _GNU_SOURCE

#include <dlfcn.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

// Of process.c.
extern void spintop_end_without_memory(void);

// Memory for the rows of a table is asked for at once and checked, with a message of its own. Such requests are at least so
// large, in bytes.
enum { checked_size = 64 * 1024 * 1024 };

static void end(int number) {
    (void)number;
    spintop_end_without_memory();
}

// Answers a request. After a large one that was refused, the use of a null pointer is taken for that of its memory.
static void *answer(void *memory, size_t bytes) {
    struct sigaction ending;
    if (memory != NULL || bytes == 0) return memory;
    if (bytes < checked_size) spintop_end_without_memory();
    memset(&ending, 0, sizeof ending);
    ending.sa_handler = end;
    sigaction(SIGSEGV, &ending, NULL);
    return memory;
}

// The next definitions of these functions: those of the C library, or of another allocator that is preloaded.
#define NEXT(name, result, arguments) \
    static result(*next) arguments; \
    if (next == NULL) *(void **)&next = dlsym(RTLD_NEXT, name)

void *malloc(size_t bytes) {
    NEXT("malloc", void *, (size_t));
    return answer(next(bytes), bytes);
}

void *calloc(size_t count, size_t size) {
    NEXT("calloc", void *, (size_t, size_t));
    return answer(next(count, size), size != 0 && count > SIZE_MAX / size ? SIZE_MAX : count * size);
}

void *realloc(void *memory, size_t bytes) {
    NEXT("realloc", void *, (void *, size_t));
    return answer(next(memory, bytes), bytes);
}

#endif
