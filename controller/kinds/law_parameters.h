// The numbers that single laws declare, with their values.
#pragma once

#include <array>
#include <span>

#include "common/types.h"
#include "lcmtypes/gains_table.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// The parameters that all laws declare: LawCatalog::parameters.
using LawRows = std::span<const GainRow* const>;

/// One value for each parameter of each law. A law declares a parameter as a GainRow in its file
/// and lists it in its entry; the registry gives the row its slot. In the cycle.
class LawParameters {
 public:
  static constexpr int kMostScalars = 32;
  static constexpr int kMostMatrices = 8;

  /// All at their defaults; matrices n x n with the default on the diagonal. The rows outlive this.
  LawParameters(int joints, LawRows rows) noexcept;

  LawRows rows() const noexcept { return rows_; }

  double number(const GainRow& row) const noexcept { return scalars_[index(row)]; }
  bool on(const GainRow& row) const noexcept { return number(row) != 0.0; }
  template <typename Choice>
  Choice choice(const GainRow& row) const noexcept {
    return static_cast<Choice>(static_cast<int>(number(row)));
  }
  /// Of a parameter with one value a joint: n x n, by the message diagonal.
  const MatrixJ& matrix(const GainRow& row) const noexcept { return matrices_[index(row)]; }

  void set(const GainRow& row, double value) noexcept { scalars_[index(row)] = value; }
  void set(const GainRow& row, const MatrixJ& value) noexcept { matrices_[index(row)] = value; }

  /// True if a parameter that does not ramp differs.
  bool jumps_from(const LawParameters& other) const noexcept;
  /// (1 - s) from + s to for the joint parameters that ramp.
  void mix(double s, const LawParameters& from, const LawParameters& to) noexcept;

 private:
  static std::size_t index(const GainRow& row) noexcept {
    return static_cast<std::size_t>(row.slot);
  }

  LawRows rows_;
  std::array<double, kMostScalars> scalars_{};
  std::array<MatrixJ, kMostMatrices> matrices_;
};

}  // namespace limber::controller
#pragma GCC visibility pop
