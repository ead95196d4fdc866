// SPDX-License-Identifier: GPL-3.0-or-later
// A vector of samples: included once a SIMD target inside its namespace, after packet_vectors.inl.

/// As far as the test needs them.
struct Samples {
    V x, y, t, u, v, inverse_focus;
    static constexpr int kCoordinates = 6;

    template <bool kMoving, Lens kLens>
    static constexpr bool has(int k) {
        return k < 2 || (k == 2 && kMoving) || ((k == 3 || k == 4) && kLens != Lens::None) ||
               (k == 5 && kLens == Lens::Refocused);
    }

    /// Calls visit(coordinate, its number) for those that there are.
    template <bool kMoving, Lens kLens, class Visit>
    HWY_INLINE void for_each(Visit visit) {
        visit(x, 0);
        visit(y, 1);
        if constexpr (kMoving) visit(t, 2);
        if constexpr (kLens != Lens::None) {
            visit(u, 3);
            visit(v, 4);
        }
        if constexpr (kLens == Lens::Refocused) visit(inverse_focus, 5);
    }
};
