// SPDX-License-Identifier: GPL-3.0-or-later
// Included inside a namespace: granita (micropolygon.h), and once a SIMD target, because a function
// of vectors must be compiled for the target whose vectors it takes.  See micropolygon.h.

/// V: float, double or a SIMD vector of floats.
template <class V>
struct Corner {
    V x, y, w, z;
};

template <class V>
struct Offset {
    V x, y;
};

/// `delta` = end - begin, formed once; t in [0, 1] of the segment.
template <class V>
inline Corner<V> at_time(const Corner<V>& begin, const Corner<V>& delta, const V& t) {
    return {begin.x + t * delta.x, begin.y + t * delta.y, begin.w + t * delta.w,
            begin.z + t * delta.z};
}

template <class V>
inline Offset<V> offset_pinhole(const Corner<V>& c, const V& x, const V& y) {
    return {c.x - x * c.w, c.y - y * c.w};
}

/// u, v: lens point times lens radius times pixels per unit slope.
template <class V>
inline Offset<V> offset_lens(const Corner<V>& c, const V& x, const V& y, const V& u, const V& v,
                             const V& inverse_focus, const V& one) {
    const V shear = c.z * inverse_focus - one;
    return {(c.x + u * shear) - x * c.w, (c.y + v * shear) - y * c.w};
}

template <class V>
inline V edge(const Offset<V>& a, const Offset<V>& b) {
    return a.x * b.y - a.y * b.x;
}
