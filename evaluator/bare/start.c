/* A program without the C library, for x86-64 Linux: evaluates the images that were linked in and writes the answers' bytes to its
   standard output. What it gives to the evaluator is all there is: the
   functions on memory that compilers may call, and a place to end. */

#include <stddef.h>
#include <stdint.h>

enum { ANSWER = 31 };

int bare_f64(const void *image, size_t bytes, const double *pressures, size_t count, double into[ANSWER]);
int bare_f32(const void *image, size_t bytes, const float *pressures, size_t count, float into[ANSWER]);

void *memcpy(void *restrict to, const void *restrict from, size_t count) {
    unsigned char *t = to;
    const unsigned char *f = from;
    while (count--) *t++ = *f++;
    return to;
}

void *memmove(void *to, const void *from, size_t count) {
    unsigned char *t = to;
    const unsigned char *f = from;
    if ((uintptr_t)t < (uintptr_t)f) {
        while (count--) *t++ = *f++;
    } else {
        while (count--) t[count] = f[count];
    }
    return to;
}

void *memset(void *to, int value, size_t count) {
    unsigned char *t = to;
    while (count--) *t++ = (unsigned char)value;
    return to;
}

int memcmp(const void *one, const void *other, size_t count) {
    const unsigned char *a = one, *b = other;
    for (; count--; a++, b++) {
        if (*a != *b) return *a < *b ? -1 : 1;
    }
    return 0;
}

int bcmp(const void *one, const void *other, size_t count) {
    return memcmp(one, other, count);
}

/* The images, as they would lie in flash memory. */
#define IMAGE(name)                                                                                                                \
    __asm__(".section .rodata\n.balign 8\n" #name ":\n.incbin \"" #name ".img\"\n" #name "_end:\n.previous\n");                    \
    extern const unsigned char name[], name##_end[]

IMAGE(module_f64);
IMAGE(module_f32);
IMAGE(free_f64);
IMAGE(free_f32);

static long call(long number, long a, long b, long c) {
    long result;
    __asm__ volatile("syscall" : "=a"(result) : "a"(number), "D"(a), "S"(b), "d"(c) : "rcx", "r11", "memory");
    return result;
}

static _Noreturn void leave(int code) {
    for (;;) call(60, code, 0, 0);
}

/* Where the evaluator ends when it panics. */
_Noreturn void bare_panicked(void);
_Noreturn void bare_panicked(void) {
    leave(3);
}

static void put(const void *bytes, size_t count) {
    if (call(1, 1, (long)bytes, (long)count) != (long)count) leave(2);
}

#define ANSWER_OF(precision, number, name, pressures)                                                                              \
    do {                                                                                                                           \
        number into[ANSWER];                                                                                                       \
        size_t bytes = (size_t)(name##_end - name);                                                                                \
        if (bare_##precision(name, bytes, pressures, sizeof pressures / sizeof *pressures, into)) leave(1);                        \
        put(into, sizeof into);                                                                                                    \
    } while (0)

static _Noreturn void run(void) {
    static const double of_module[] = {10e3, 30e3, 2e3, 9e3, 42e3, 8e3, 12e3, 0.0, 20e3, 22e3, 31e3, 7e3};
    static const double of_free[] = {2e3, 9e3, 5e3};
    static const float of_module_short[] = {10e3f, 30e3f, 2e3f, 9e3f, 42e3f, 8e3f, 12e3f, 0.0f, 20e3f, 22e3f, 31e3f, 7e3f};
    static const float of_free_short[] = {2e3f, 9e3f, 5e3f};
    ANSWER_OF(f64, double, module_f64, of_module);
    ANSWER_OF(f64, double, free_f64, of_free);
    ANSWER_OF(f32, float, module_f32, of_module_short);
    ANSWER_OF(f32, float, free_f32, of_free_short);
    leave(0);
}

/* The stack is aligned as at a call. */
__asm__(".globl _start\n_start:\nxor %ebp, %ebp\nand $-16, %rsp\ncall begin\n");
_Noreturn void begin(void);
_Noreturn void begin(void) {
    run();
}
