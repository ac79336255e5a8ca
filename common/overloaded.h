// One visitor for std::visit from a handler for each type.
#pragma once

namespace limber {

template <typename... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};

// Clang before 17 does not deduce the arguments of aggregates by itself.
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

}  // namespace limber
