// A gains request changes what it names; everything else stays.
#pragma once

#include <limber/compliance_gains_t.hpp>
#include <string>
#include <string_view>

namespace limber {

/// Puts the fields that count in `request` (compliance_gains_t::scope) into `present`. A block of
/// K_x alone clears its coupling with the other block. Parameters of single laws, `law` and
/// `ramp_s` are left to the caller. May be called in the cycle.
void merge_gains(const compliance_gains_t& request, compliance_gains_t* present) noexcept;

/// The first key in `named` that no field has, nullptr if there is none. May be called in the
/// cycle.
const char* unknown_gain(const compliance_gains_t& request) noexcept;

/// The field's key is in `named`. May be called in the cycle.
bool names_gain(const compliance_gains_t& request, std::string_view key) noexcept;

/// Adds a key to `named`.
void name_gain(const char* key, compliance_gains_t* request);

/// Key of one part of a map such as period_cycles: `period_cycles.inertia`.
std::string part_key(const char* key, const char* part);

}  // namespace limber
