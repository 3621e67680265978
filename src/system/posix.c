// What Fortran cannot say to the operating system. Every function that can fail returns an
// errno value, 0 for success.

#define _DEFAULT_SOURCE // flock
#define _POSIX_C_SOURCE 200809L

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

// What spintop_reason says of a file that another run has locked; no errno value.
enum { in_use = -1 };

int spintop_open(const char *path, int *file) {
    do {
        *file = open(path, O_RDONLY | O_CLOEXEC);
    } while (*file < 0 && errno == EINTR);
    return *file < 0 ? errno : 0;
}

// Locks a regular file for this run. Where the file system knows no locks the file stays unlocked:
// not to run there at all would be worse.
static int lock(int file) {
    struct stat info;
    if (fstat(file, &info) < 0) return errno;
    if (!S_ISREG(info.st_mode) || flock(file, LOCK_EX | LOCK_NB) == 0) return 0;
    if (errno == EWOULDBLOCK) return in_use;
    return errno == ENOLCK || errno == ENOSYS || errno == EOPNOTSUPP || errno == EINVAL ? 0 : errno;
}

// Between the opening and the lock another run may have renamed the file.
static int still_has_name(int file, const char *path) {
    struct stat opened, named;
    return fstat(file, &opened) == 0 && stat(path, &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

// Opens a file for writing at its end, makes it where it is missing, and locks it until it is closed.
int spintop_open_locked(const char *path, int *file) {
    for (;;) {
        int status;
        *file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
        if (*file < 0 && errno == EINTR) continue;
        if (*file < 0) return errno;
        status = lock(*file);
        if (status == 0 && still_has_name(*file, path)) return 0;
        close(*file);
        *file = -1;
        if (status != 0) return status;
    }
}

int spintop_write(int file, const char *bytes, long long count) {
    while (count > 0) {
        const ssize_t written = write(file, bytes, (size_t)count);
        if (written < 0) {
            if (errno == EINTR) continue;
            return errno;
        }
        bytes += written;
        count -= written;
    }
    return 0;
}

// Reads until the end of the file or until the room is full.
int spintop_read(int file, char *bytes, long long room, long long *count) {
    *count = 0;
    while (*count < room) {
        const ssize_t got = read(file, bytes + *count, (size_t)(room - *count));
        if (got == 0) break;
        if (got < 0) {
            if (errno == EINTR) continue;
            return errno;
        }
        *count += got;
    }
    return 0;
}

int spintop_sync(int file) {
    int result;
    do {
        result = fsync(file);
    } while (result < 0 && errno == EINTR);
    // Some file systems and special files cannot be synchronised at all; that is no failure.
    if (result < 0 && (errno == EINVAL || errno == ENOTSUP || errno == EROFS)) return 0;
    return result < 0 ? errno : 0;
}

// Returns when the names in a folder are on the disk. One that may not be read cannot be synchronised.
int spintop_sync_folder(const char *path) {
    int file;
    int status = spintop_open(path, &file);
    if (status != 0) return status == EACCES ? 0 : status;
    status = spintop_sync(file);
    close(file);
    return status;
}

// A special file has no size that could be cut.
int spintop_truncate(int file, long long size) {
    struct stat info;
    int result;
    if (fstat(file, &info) < 0) return errno;
    if (!S_ISREG(info.st_mode)) return 0;
    do {
        result = ftruncate(file, (off_t)size);
    } while (result < 0 && errno == EINTR);
    return result < 0 ? errno : 0;
}

// On Linux the descriptor is gone even when close is interrupted: no second try.
int spintop_close(int file) {
    return close(file) < 0 && errno != EINTR ? errno : 0;
}

int spintop_rename(const char *from, const char *to) {
    return rename(from, to) < 0 ? errno : 0;
}

int spintop_remove(const char *path) {
    return unlink(path) < 0 ? errno : 0;
}

int spintop_make_folder(const char *path) {
    return mkdir(path, 0777) < 0 ? errno : 0;
}

// Removes a folder and the files in it.
int spintop_remove_folder(const char *path) {
    DIR *folder = opendir(path);
    if (folder == NULL) return errno;
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        unlinkat(dirfd(folder), entry->d_name, 0); // fails for . and ..
    }
    closedir(folder);
    return rmdir(path) < 0 ? errno : 0;
}

// Makes a folder that no other process has; `path` ends with XXXXXX, which become its name.
int spintop_make_private_folder(char *path) {
    return mkdtemp(path) == NULL ? errno : 0;
}

// size is -1 if there is nothing of that name.
void spintop_inspect(const char *path, long long *size, int *is_folder) {
    struct stat info;
    *size = -1;
    *is_folder = 0;
    if (stat(path, &info) < 0) return;
    *size = (long long)info.st_size;
    *is_folder = S_ISDIR(info.st_mode);
}

// Whether two paths name one file, which exists.
int spintop_is_same_file(const char *a, const char *b) {
    struct stat one, other;
    return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

int spintop_is_terminal(int file) {
    return isatty(file);
}

void spintop_pause(double seconds) {
    struct timespec span = {(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&span, NULL);
}

double spintop_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double spintop_processor_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// YYYY-MM-DDThh:mm:ssZ
void spintop_utc(char *text, int room) {
    const time_t now = time(NULL);
    struct tm parts;
    gmtime_r(&now, &parts);
    strftime(text, (size_t)room, "%Y-%m-%dT%H:%M:%SZ", &parts);
}

void spintop_host(char *text, int room) {
    if (gethostname(text, (size_t)room) < 0) text[0] = '\0';
    text[room - 1] = '\0';
}

// Largest resident memory so far, in bytes.
long long spintop_peak_memory(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1024LL * usage.ru_maxrss;
}

// Memory of the machine, in bytes.
long long spintop_physical_memory(void) {
    return (long long)sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGESIZE);
}

void spintop_reason(int number, char *text, int room) {
    if (number == in_use) {
        snprintf(text, (size_t)room, "another run is writing it");
        return;
    }
    if (strerror_r(number, text, (size_t)room) != 0) text[0] = '\0';
    text[room - 1] = '\0';
}

/* Columns of the terminal that a file is; 0 for any other file, or where they are not known. */
int spintop_terminal_width(int file) {
    struct winsize size;
    return isatty(file) && ioctl(file, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}
