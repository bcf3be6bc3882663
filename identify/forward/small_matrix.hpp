/// @file
/// Vectors and matrices of three whose elements are numbers of any kind (`double` or a Pack). Eigen serves everywhere
/// else; these are free of its alignment and of its shared functions, so that sources of different instruction sets
/// may use them side by side.
#pragma once

namespace wems::identify {

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
