// Numbers to text by std::to_chars: the shortest text that reads back to the same bits,
// in any locale. Fortran reaches these through spintop_text. A text has room for 24 characters a number, and one for a comma.

#include <charconv>
#include <cmath>
#include <cstring>

namespace {

char *write_word(char *first, const char *word) {
    const std::size_t length = std::strlen(word);
    std::memcpy(first, word, length);
    return first + length;
}

char *write_real(char *first, char *last, double value) {
    if (std::isnan(value)) return write_word(first, "nan");
    if (std::isinf(value)) return write_word(first, value < 0 ? "-inf" : "inf");
    return std::to_chars(first, last, value).ptr;
}

} // namespace

extern "C" int spintop_integer_to_text(long long value, char *text, int capacity) {
    return static_cast<int>(std::to_chars(text, text + capacity, value).ptr - text);
}

extern "C" int spintop_reals_to_text(const double *values, int count, char *text, int capacity) {
    char *next = text;
    for (int i = 0; i < count; ++i) {
        if (i > 0) *next++ = ',';
        next = write_real(next, text + capacity, values[i]);
    }
    return static_cast<int>(next - text);
}
