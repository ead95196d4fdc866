// SPDX-License-Identifier: GPL-3.0-or-later
// Where vectors of samples lie in the two triangles of a micropolygon: included once a SIMD target
// inside its namespace, like corner_arithmetic.inl, after packet_vectors.inl.

struct PairEdges {
    V e01, e12, e02, e23, e30;
};

HWY_INLINE PairEdges edges_of(const Offset<V>& d0, const Offset<V>& d1, const Offset<V>& d2,
                              const Offset<V>& d3) {
    return {edge(d0, d1), edge(d1, d2), edge(d0, d2), edge(d2, d3), edge(d3, d0)};
}

/// in: inside or on the border; strict: inside.
struct Side {
    M in, strict;
};

HWY_INLINE Side side_of(V a, V b, V c) {
    const V zero = set(0.0f);
    const V least = hn::Min(hn::Min(a, b), c), most = hn::Max(hn::Max(a, b), c);
    return {hn::Or(hn::Ge(least, zero), hn::Le(most, zero)),
            hn::Or(hn::Gt(least, zero), hn::Lt(most, zero))};
}
HWY_INLINE Side first_side(const PairEdges& e) {
    return side_of(e.e01, e.e12, hn::Neg(e.e02));
}
HWY_INLINE Side second_side(const PairEdges& e) {
    return side_of(e.e02, e.e23, e.e30);
}

/// Strictly inside one triangle and outside the other; the rest of what is inside is on an edge or
/// where the micropolygon is folded, and needs hit_micropolygon.
HWY_INLINE M is_clean(const Side& a, const Side& b) {
    return hn::Or(hn::AndNot(b.in, a.strict), hn::AndNot(a.in, b.strict));
}

/// Weights of the second and third corner of triangle (0, 1, 2) or (0, 2, 3).
struct PairWeights {
    V second, third;
};

HWY_INLINE PairWeights weights_of(const PairEdges& e, M in_first) {
    const V first = hn::IfThenElse(in_first, e.e12, e.e23);
    const V second = hn::IfThenElse(in_first, hn::Neg(e.e02), e.e30);
    const V third = hn::IfThenElse(in_first, e.e01, e.e02);
    const V share = set(1.0f) / (first + second + third);
    return {second * share, third * share};
}
