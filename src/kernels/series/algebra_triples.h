// What algebras have in common whose vectors are three numbers, in rows one after another.

typedef struct {
    num x, y, z;
} vec;

inlined vec load_vec(const element *row) { return (vec){load_num(row), load_num(row + stride), load_num(row + 2 * stride)}; }
inlined vec load_constant(const element *row) { return load_vec(row); }
inlined void store_vec(element *row, vec a) {
    store_num(row, a.x), store_num(row + stride, a.y), store_num(row + 2 * stride, a.z);
}
inlined void store_constant(element *row, vec a) { store_vec(row, a); }
inlined vec vec_of(num x, num y, num z) { return (vec){x, y, z}; }
inlined vec ahead(vec a) { return (vec){a.y, a.z, a.x}; }
inlined vec behind(vec a) { return (vec){a.z, a.x, a.y}; }
inlined vec load_ahead(const element *row) { return ahead(load_vec(row)); }
inlined vec load_behind(const element *row) { return behind(load_vec(row)); }
inlined vec add(vec a, vec b) { return (vec){a.x + b.x, a.y + b.y, a.z + b.z}; }
inlined vec sub(vec a, vec b) { return (vec){a.x - b.x, a.y - b.y, a.z - b.z}; }
inlined vec mul(vec a, vec b) { return (vec){a.x * b.x, a.y * b.y, a.z * b.z}; }
inlined vec by(num a, vec b) { return (vec){a * b.x, a * b.y, a * b.z}; }
inlined num sum_of(vec a) { return a.x + (a.y + a.z); }
