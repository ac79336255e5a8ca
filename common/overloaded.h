// One visitor for std::visit from a handler for each type.
#pragma once

namespace limber {

template <typename... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};

}  // namespace limber
