/// @file
/// Several numbers side by side, one for each of the parameter sets that are simulated together. Arithmetic is of the
/// compiler's vector types, so that it becomes whatever the instruction set of the source offers.
#pragma once

namespace wems::identify {

inline double least(double a, double b) {
    return a < b ? a : b;
}
inline double whereNegative(double test, double then, double otherwise) {
    return test < 0 ? then : otherwise;
}
inline double lane(double x, int) {
    return x;
}
inline void setLane(double& x, int, double value) {
    x = value;
}

/// The vector types of g++ and clang.
template <int lanes>
struct PackValues;
template <>
struct PackValues<2> {
    typedef double Type __attribute__((vector_size(16)));  // NOLINT(modernize-use-using): the attribute
};
template <>
struct PackValues<4> {
    typedef double Type __attribute__((vector_size(32)));  // NOLINT(modernize-use-using)
};
template <>
struct PackValues<8> {
    typedef double Type __attribute__((vector_size(64)));  // NOLINT(modernize-use-using)
};

template <int lanes>
struct Pack {
    using Values = typename PackValues<lanes>::Type;
    Values v;

    Pack() = default;
    Pack(double x) : v(x - Values{}) {}  // NOLINT(google-explicit-constructor): constants in formulas
    explicit Pack(const Values& values) : v(values) {}

    friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.v + b.v); }
    friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.v - b.v); }
    friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.v * b.v); }
    friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v / b.v); }
    friend Pack operator-(const Pack& a) { return Pack(-a.v); }
    Pack& operator+=(const Pack& b) {
        v += b.v;
        return *this;
    }
    Pack& operator-=(const Pack& b) {
        v -= b.v;
        return *this;
    }

    friend Pack positivePart(const Pack& x) { return Pack(x.v > 0 ? x.v : Values{}); }
    friend Pack least(const Pack& a, const Pack& b) { return Pack(a.v < b.v ? a.v : b.v); }
    friend Pack whereNegative(const Pack& test, const Pack& then, const Pack& otherwise) {
        return Pack(test.v < 0 ? then.v : otherwise.v);
    }
    friend double lane(const Pack& x, int i) { return x.v[i]; }
    friend void setLane(Pack& x, int i, double value) { x.v[i] = value; }

    // Where no vector function exists: one after the other.
    template <class Function>
    static Pack each(const Pack& x, const Function& function) {
        Pack result = x;
        for (int i = 0; i < lanes; ++i) result.v[i] = function(x.v[i]);
        return result;
    }
    template <class Function, class... More>
    friend Pack perNumber(const Function& function, const Pack& first, const More&... more) {
        Pack result = first;
        for (int i = 0; i < lanes; ++i) result.v[i] = function(first.v[i], more.v[i]...);
        return result;
    }
    friend Pack reciprocalRoot(const Pack& x) {
        return each(x, [](double s) { return 1 / __builtin_sqrt(s); });
    }
    friend Pack hyperbolicTangent(const Pack& x) {
        return each(x, [](double s) { return __builtin_tanh(s); });
    }
    friend Pack decayedPart(const Pack& x) {
        return each(x, [](double s) { return s > 0 ? -__builtin_expm1(-s) : s; });
    }
};

// Vectors and matrices of three whose elements are numbers of any kind (`double` or a Pack). Eigen serves everywhere
// else; these are free of its alignment and of its shared functions, so that sources of different instruction sets
// may use them side by side.

template <class T>
struct Vec3 {
    T x = 0.0, y = 0.0, z = 0.0;

    static Vec3 load(const T* from) { return {from[0], from[1], from[2]}; }
    void store(T* to) const {
        to[0] = x;
        to[1] = y;
        to[2] = z;
    }
    friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3 operator*(const T& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
    friend T dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    friend Vec3 cross(const Vec3& a, const Vec3& b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
};

/// By columns.
template <class T>
struct Mat3 {
    Vec3<T> x, y, z;

    static Mat3 load(const T* from) { return {Vec3<T>::load(from), Vec3<T>::load(from + 3), Vec3<T>::load(from + 6)}; }
    friend Vec3<T> operator*(const Mat3& m, const Vec3<T>& a) { return a.x * m.x + a.y * m.y + a.z * m.z; }
    friend Vec3<T> transposed(const Mat3& m, const Vec3<T>& a) { return {dot(m.x, a), dot(m.y, a), dot(m.z, a)}; }
};

}  // namespace wems::identify
