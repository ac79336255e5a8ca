// A law of your own, in a shared library: one file outside limber's tree that ends in
//
//   LIMBER_LAW(my_law)     // exports LawEntry my_law()
//
// Controller and lab open it before their first cycle ($LIMBER_LAWS, or `law_file:` of a scenario)
// and never close it; from then on a call of the law is a virtual call like any other. `limber law
// new` writes the file, `limber law check` tests it, limber_add_law() of limber's CMake package
// builds it.
#pragma once

#include <limber/version.h>

#include <array>
#include <cstdint>

#include "common/public.h"
#include "controller/laws/law.h"

namespace limber::controller {

/// What library and program have to agree on, each by its own compiler.
struct LayoutFigure {
  const char* what;
  std::uint64_t value;
};

inline constexpr std::array kLawLayout = {
    LayoutFigure{"size of LawInputs", sizeof(LawInputs)},
    LayoutFigure{"size of LawOutput", sizeof(LawOutput)},
    LayoutFigure{"size of LawEntry", sizeof(LawEntry)},
    LayoutFigure{"size of GainRow", sizeof(GainRow)},
    LayoutFigure{"size of Gains", sizeof(Gains)},
    LayoutFigure{"size of Goal", sizeof(Goal)},
    LayoutFigure{"size of ArmTerms", sizeof(ArmTerms)},
    LayoutFigure{"size of ArmModel", sizeof(ArmModel)},
    LayoutFigure{"size of Robot", sizeof(Robot)},
    LayoutFigure{"Eigen's alignment", EIGEN_MAX_ALIGN_BYTES},
    LayoutFigure{"ABI of the compiler", __GXX_ABI_VERSION},
};

/// The symbol `limber_law` of the library.
struct LawPlugin {
  const char* version;  ///< of limber, whose headers it was compiled with
  std::size_t figures;
  const LayoutFigure* layout;
  LawEntry (*entry)();
};

}  // namespace limber::controller

#define LIMBER_LAW(function)                                               \
  extern "C" LIMBER_PUBLIC const limber::controller::LawPlugin limber_law; \
  const limber::controller::LawPlugin limber_law = {                       \
      LIMBER_VERSION, limber::controller::kLawLayout.size(),               \
      limber::controller::kLawLayout.data(), &(function)}
