// Vectors of three numbers in double precision, and boxes along the axes.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

namespace raya {

struct Vec3 {
    double x = 0, y = 0, z = 0;

    constexpr Vec3() = default;
    constexpr explicit Vec3(double all) : Vec3(all, all, all) {}
    constexpr Vec3(double x_value, double y_value, double z_value) : x(x_value), y(y_value), z(z_value) {}

    double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    friend bool operator==(const Vec3&, const Vec3&) = default;

    friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3 operator*(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
    friend Vec3 operator/(const Vec3& a, const Vec3& b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
    friend Vec3 operator*(const Vec3& a, double factor) { return a * Vec3(factor); }
    friend Vec3 operator*(double factor, const Vec3& a) { return a * Vec3(factor); }
    friend Vec3 operator/(const Vec3& a, double divisor) { return a / Vec3(divisor); }
    Vec3 operator-() const { return {-x, -y, -z}; }
    Vec3& operator+=(const Vec3& other) { return *this = *this + other; }
    Vec3& operator-=(const Vec3& other) { return *this = *this - other; }
    Vec3& operator*=(double factor) { return *this = *this * factor; }
    Vec3& operator/=(double divisor) { return *this = *this / divisor; }

    double dot(const Vec3& other) const { return x * other.x + y * other.y + z * other.z; }
    Vec3 cross(const Vec3& other) const {
        return {y * other.z - z * other.y, z * other.x - x * other.z, x * other.y - y * other.x};
    }
    double length2() const { return dot(*this); }
    double length() const {
        if (length2() >= 2 * std::numeric_limits<double>::min()) return std::sqrt(length2());
        const double largest = std::max({std::abs(x), std::abs(y), std::abs(z)});  // the square may underflow
        return largest > 0 ? largest * std::sqrt((*this / largest).length2()) : 0;
    }
    /// Returns the vector of length 1 in this direction; 0 for a vector of length 0.
    Vec3 normalized() const { return length() > 0 ? *this / length() : Vec3(); }
};

/// A box along the axes. It is empty until a point is added.
struct Box {
    static constexpr double kMax = std::numeric_limits<double>::max();
    Vec3 min{kMax}, max{-kMax};

    friend bool operator==(const Box&, const Box&) = default;

    bool is_empty() const { return max.x < min.x || max.y < min.y || max.z < min.z; }
    Vec3 size() const { return is_empty() ? Vec3() : max - min; }
    Vec3 centre() const { return (max + min) / 2; }
    /// Returns the point of the box that is nearest to `p`.
    Vec3 nearest(const Vec3& p) const {
        return {std::clamp(p.x, min.x, max.x), std::clamp(p.y, min.y, max.y), std::clamp(p.z, min.z, max.z)};
    }
    bool intersects(const Box& other) const {
        const auto overlap = [&](int axis) { return min[axis] <= other.max[axis] && other.min[axis] <= max[axis]; };
        return overlap(0) && overlap(1) && overlap(2);
    }

    /// Extends the box so that it contains another box.
    void extend(const Box& other) {
        for (int axis = 0; axis < 3; ++axis) {
            min[axis] = std::min(min[axis], other.min[axis]);
            max[axis] = std::max(max[axis], other.max[axis]);
        }
    }
    void extend(const Vec3& point) { extend({point, point}); }
};

}  // namespace raya
