// What Fortran cannot say to the operating system. Every function that can fail returns an
// errno value, 0 for success.

#define _DEFAULT_SOURCE // flock
#define _POSIX_C_SOURCE 200809L

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

// What spintop_reason says beside errno values.
enum { in_use = -1, is_link = -2, has_links = -3, is_special = -4, keeps_moving = -5, was_changed = -6, no_locks = -7 };

// Characters of a text that is made here for Fortran, as in files.f90.
enum { room_of_text = 4096 };

int spintop_host(char *text);
int spintop_write(const int *file, const char *bytes, const long long *count);
void spintop_remove_lock_file(const char *path);

// Opens a file for reading. A FIFO or a device, which may never answer, is refused where only a regular file is wanted.
static int open_input(const char *path, int only_regular, int *file) {
    struct stat info;
    do {
        *file = open(path, O_RDONLY | O_CLOEXEC | (only_regular ? O_NONBLOCK | O_NOCTTY : 0));
    } while (*file < 0 && errno == EINTR);
    if (*file < 0) return only_regular && errno == ENXIO ? is_special : errno;
    if (!only_regular || (fstat(*file, &info) == 0 && S_ISREG(info.st_mode))) return 0;
    close(*file);
    *file = -1;
    return is_special;
}

int spintop_open(const char *path, int *file) { return open_input(path, 0, file); }

int spintop_open_regular(const char *path, int *file) { return open_input(path, 1, file); }

// Why a file is not written: through a link the bytes would go elsewhere, and what is no file may never take them.
static int unfit(const struct stat *info) {
    if (S_ISLNK(info->st_mode)) return is_link;
    if (S_ISDIR(info->st_mode)) return EISDIR;
    if (!S_ISREG(info->st_mode)) return is_special;
    return info->st_nlink > 1 ? has_links : 0;
}

// Why a file cannot be replaced by renaming another one: a device or a FIFO would be lost.
int spintop_check_target(const char *path) {
    struct stat info;
    if (lstat(path, &info) < 0 || S_ISLNK(info.st_mode) || S_ISDIR(info.st_mode)) return 0;
    return S_ISREG(info.st_mode) ? 0 : is_special;
}

// Opens a file for writing at its end, and makes it where it is missing. All files that are written are opened here.
int spintop_open_own(const char *path, int *file) {
    struct stat info;
    int status;
    *file = -1;
    if (lstat(path, &info) == 0) {
        status = unfit(&info); // before it is opened: the opening of a device may do something
        if (status != 0) return status;
    }
    do {
        *file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY, 0666);
    } while (*file < 0 && errno == EINTR);
    if (*file < 0) return errno;
    status = fstat(*file, &info) < 0 ? errno : unfit(&info);
    if (status == 0) return 0;
    close(*file);
    *file = -1;
    return status;
}

// Locks a file for this run.
static int lock(int file) {
    if (flock(file, LOCK_EX | LOCK_NB) == 0) return 0;
    if (errno == EWOULDBLOCK) return in_use;
    return errno == ENOLCK || errno == ENOSYS || errno == EOPNOTSUPP || errno == EINVAL ? no_locks : errno;
}

// The lock files of this process.
enum { most_held = 64, room_of_name = PATH_MAX + 8 };
static char held[most_held][room_of_name];
static atomic_int is_held[most_held];

// In place of a lock, where the file system has none: a file beside the other one, which only one run can make. It names the
// run, and stays if that is killed.
static int make_lock_file(const char *path) {
    char host[room_of_text], text[room_of_text + 32];
    long long length;
    int file, status, place = 0;
    while (place < most_held && is_held[place]) ++place;
    if (place == most_held) return ENOLCK;
    if (snprintf(held[place], room_of_name, "%s.lock", path) >= PATH_MAX) return ENAMETOOLONG;
    file = open(held[place], O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file < 0) return errno == EEXIST ? no_locks : errno;
    spintop_host(host);
    length = snprintf(text, sizeof text, "%s %ld\n", host, (long)getpid());
    status = spintop_write(&file, text, &length);
    close(file);
    if (status != 0) unlink(held[place]);
    is_held[place] = status == 0;
    return status;
}

// Removes the lock file that was made for a file, or for all of them (NULL); safe in the handler of a signal.
void spintop_remove_lock_file(const char *path) {
    const size_t length = path == NULL ? 0 : strlen(path);
    for (int i = 0; i < most_held; ++i) {
        if (!is_held[i]) continue;
        if (path != NULL && (strncmp(held[i], path, length) != 0 || strcmp(held[i] + length, ".lock") != 0)) continue;
        unlink(held[i]);
        is_held[i] = 0;
    }
}

static int is_same(const struct stat *a, const struct stat *b) { return a->st_dev == b->st_dev && a->st_ino == b->st_ino; }

// Whether a file still has the name under which it was opened, and the size that was written to it (-1: any). If not,
// another program has been at it, and its contents are not to be trusted.
int spintop_check_written(const int *file, const char *path, const long long *size) {
    struct stat opened, named;
    if (fstat(*file, &opened) < 0 || lstat(path, &named) < 0) return errno;
    return is_same(&opened, &named) && (*size < 0 || opened.st_size == (off_t)*size) ? 0 : was_changed;
}

// The same as spintop_open_own, and locks the file until it is closed. Where the file system has no locks, a file
// PATH.lock is made, which the caller removes.
int spintop_open_locked(const char *path, int *file) {
    enum { most_tries = 100 };
    const long long any_size = -1;
    for (int tries = 0; tries < most_tries; ++tries) {
        int status = spintop_open_own(path, file);
        if (status != 0) return status;
        status = lock(*file);
        if (status == no_locks) status = make_lock_file(path);
        // Between the opening and the lock another run may have renamed the file.
        if (status == 0 && spintop_check_written(file, path, &any_size) == 0) return 0;
        if (status == 0) spintop_remove_lock_file(path);
        close(*file);
        *file = -1;
        if (status != 0) return status;
    }
    return keeps_moving;
}

int spintop_write(const int *file, const char *bytes, const long long *count) {
    const char *const end = bytes + *count;
    while (bytes < end) {
        const ssize_t written = write(*file, bytes, (size_t)(end - bytes));
        if (written < 0) {
            if (errno == EINTR) continue;
            return errno;
        }
        bytes += written;
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

int spintop_sync(const int *file) {
    int result;
    do {
        result = fsync(*file);
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
    status = spintop_sync(&file);
    close(file);
    return status;
}

int spintop_truncate(int file, long long size) {
    int result;
    do {
        result = ftruncate(file, (off_t)size);
    } while (result < 0 && errno == EINTR);
    return result < 0 ? errno : 0;
}

// On Linux the descriptor is gone even when close is interrupted: no second try.
int spintop_close(const int *file) { return close(*file) < 0 && errno != EINTR ? errno : 0; }

int spintop_rename(const char *from, const char *to) {
    const int status = spintop_check_target(to);
    if (status != 0) return status;
    return rename(from, to) < 0 ? errno : 0;
}

int spintop_remove(const char *path) { return unlink(path) < 0 ? errno : 0; }

int spintop_make_folder(const char *path) { return mkdir(path, 0777) < 0 ? errno : 0; }

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

// Makes a folder that no other process has, in TMPDIR or in /tmp.
int spintop_private_folder(char *path) {
    const char *folder = getenv("TMPDIR");
    snprintf(path, room_of_text, "%s/spintop.XXXXXX", folder != NULL && *folder != '\0' ? folder : "/tmp");
    return mkdtemp(path) == NULL ? errno : 0;
}

// -1 if there is nothing of that name.
long long spintop_file_size(const char *path) {
    struct stat info;
    return stat(path, &info) < 0 ? -1 : (long long)info.st_size;
}

int spintop_is_folder(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

// Whether two paths name one file, which exists.
int spintop_is_same_file(const char *a, const char *b) {
    struct stat one, other;
    return stat(a, &one) == 0 && stat(b, &other) == 0 && is_same(&one, &other);
}

void spintop_pause(double seconds) {
    struct timespec span = {(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&span, NULL);
}

static double time_of(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double spintop_seconds(void) { return time_of(CLOCK_MONOTONIC); }

double spintop_processor_seconds(void) { return time_of(CLOCK_THREAD_CPUTIME_ID); }

// YYYY-MM-DDThh:mm:ssZ
int spintop_utc(char *text) {
    const time_t now = time(NULL);
    struct tm parts;
    gmtime_r(&now, &parts);
    return strftime(text, room_of_text, "%Y-%m-%dT%H:%M:%SZ", &parts) == 0;
}

int spintop_host(char *text) {
    if (gethostname(text, room_of_text) < 0) text[0] = '\0';
    text[room_of_text - 1] = '\0';
    return 0;
}

// Largest resident memory so far, in bytes. getrusage would count what the program that began this one had before exec.
long long spintop_peak_memory(void) {
    struct rusage usage;
    long long kilobytes = 0;
    char line[128];
    FILE *status = fopen("/proc/self/status", "re");
    while (status && !kilobytes && fgets(line, sizeof line, status)) sscanf(line, "VmHWM: %lld", &kilobytes);
    if (status) fclose(status);
    if (!kilobytes && getrusage(RUSAGE_SELF, &usage) == 0) kilobytes = usage.ru_maxrss;
    return 1024 * kilobytes;
}

// Memory of the machine, in bytes.
long long spintop_physical_memory(void) { return (long long)sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGESIZE); }

void spintop_reason(int number, char *text, int room) {
    static const char *const reasons[] = {
        "another run is writing it",
        "it is a symbolic link; remove it, or write elsewhere",
        "other names lead to the same file (hard links); remove it, or write elsewhere",
        "it is a device, a FIFO or a socket, not a file; give the path of a file",
        "its name passes from file to file; write elsewhere",
        "another program changed it meanwhile; run it again",
        "another run is writing it, or ended without removing the file .lock beside it; if none runs, remove that",
    };
    if (number < 0) {
        snprintf(text, (size_t)room, "%s", reasons[-number - 1]);
        return;
    }
    if (strerror_r(number, text, (size_t)room) != 0) text[0] = '\0';
    text[room - 1] = '\0';
}

// Columns of the terminal that a file is; 0 where they are not known, -1 for any other file.
int spintop_terminal_width(int file) {
    struct winsize size;
    if (!isatty(file)) return -1;
    return ioctl(file, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}
