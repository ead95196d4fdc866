// SPDX-License-Identifier: GPL-3.0-or-later
// A disk that fails late, as those of networks do: preloaded, it fails the call that FAILING_CALL
// names (open, close or fsync) with the error FAILING_ERROR for files whose names hold
// FAILING_NAME.  A close leaves half the file, as if the server had not taken the rest.  Names of
// files that were flushed or renamed go to FAILING_LOG.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char* asked(const char* variable) {
    const char* value = getenv(variable);
    return value ? value : "";
}

static int fails(const char* call, const char* path) {
    if (strcmp(call, asked("FAILING_CALL")) != 0 || !strstr(path, asked("FAILING_NAME"))) return 0;
    errno = atoi(asked("FAILING_ERROR"));
    return 1;
}

static void name_of(int descriptor, char* path, size_t size) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const ssize_t length = readlink(link, path, size - 1);
    path[length > 0 ? length : 0] = 0;
}

static void note(const char* what, const char* path) {
    const int before = errno;
    FILE* file = fopen(asked("FAILING_LOG"), "a");
    if (file) {
        fprintf(file, "%s %s\n", what, path);
        fclose(file);
    }
    errno = before;
}

FILE* fopen(const char* path, const char* mode) {
    static FILE* (*next)(const char*, const char*);
    if (!next) next = dlsym(RTLD_NEXT, "fopen");
    return mode[0] == 'w' && fails("open", path) ? NULL : next(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
    return fopen(path, mode);
}

#define FAILING_OPEN(name)                                                              \
    int name(const char* path, int flags, ...) {                                        \
        static int (*next)(const char*, int, ...);                                      \
        if (!next) next = dlsym(RTLD_NEXT, #name);                                      \
        mode_t mode = 0;                                                                \
        if (flags & O_CREAT) {                                                          \
            __builtin_va_list more;                                                     \
            __builtin_va_start(more, flags);                                            \
            mode = __builtin_va_arg(more, mode_t);                                      \
            __builtin_va_end(more);                                                     \
        }                                                                               \
        return (flags & O_CREAT) && fails("open", path) ? -1 : next(path, flags, mode); \
    }

FAILING_OPEN(open)
FAILING_OPEN(open64)

int fclose(FILE* file) {
    static int (*next)(FILE*);
    if (!next) next = dlsym(RTLD_NEXT, "fclose");
    char path[4096];
    name_of(fileno(file), path, sizeof path);
    struct stat status;
    if (strcmp(asked("FAILING_CALL"), "close") != 0 || !strstr(path, asked("FAILING_NAME")))
        return next(file);
    next(file);
    if (stat(path, &status) == 0 && truncate(path, status.st_size / 2) != 0) return EOF;
    fails("close", path);
    return EOF;
}

int fsync(int descriptor) {
    static int (*next)(int);
    if (!next) next = dlsym(RTLD_NEXT, "fsync");
    char path[4096];
    name_of(descriptor, path, sizeof path);
    note("flushed", path);
    return fails("fsync", path) ? -1 : next(descriptor);
}

int rename(const char* from, const char* to) {
    static int (*next)(const char*, const char*);
    if (!next) next = dlsym(RTLD_NEXT, "rename");
    const int result = next(from, to);
    note("renamed", to);
    return result;
}
