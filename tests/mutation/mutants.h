// Faults made on purpose, all compiled in, one chosen at run time. `limber dev mutation` copies the
// sources and writes each expression that it may change as a call of one of these functions; N is
// the number of its first mutant.
//
//   LIMBER_MUTANT=N          this mutant lives; without it all behaves as written
//   LIMBER_MUTANTS_LIST=F    at exit, the numbers of all mutants of this program are written to F
//   LIMBER_MUTANTS_REACHED=F at exit, the numbers of those that were reached are written to F
//
// What is evaluated at compile time is never changed; cell() is for tables, which lose their
// constexpr in the copy. An expression whose types permit no change has no mutant.
#pragma once

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#pragma GCC diagnostic ignored "-Wnarrowing"
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wtype-limits"
#pragma GCC diagnostic ignored "-Wbool-compare"
#pragma GCC diagnostic ignored "-Wbool-operation"
#pragma GCC diagnostic ignored "-Wfloat-equal"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wunused-value"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wunused-const-variable"
#pragma GCC diagnostic ignored "-Wunused-variable"
#pragma GCC diagnostic ignored "-Wimplicit-fallthrough"
#pragma GCC diagnostic ignored "-Wreturn-type"
#pragma GCC diagnostic ignored "-Warray-bounds"
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#pragma GCC diagnostic ignored "-Wstringop-overread"
#pragma GCC diagnostic ignored "-Woverflow"

namespace limber::mutants {

inline constexpr int kMost = 100'000;

/// Of this process; read once.
class Session {
 public:
  static Session& get() {
    static Session session;
    return session;
  }
  ~Session() {
    write("LIMBER_MUTANTS_LIST", listed_);
    write("LIMBER_MUTANTS_REACHED", reached_);
  }
  bool list(int n) {
    listed_[static_cast<std::size_t>(n)] = true;
    return true;
  }
  bool lives(int n) {
    if (recording_) reached_[static_cast<std::size_t>(n)].store(true, std::memory_order_relaxed);
    return n == chosen_;
  }

 private:
  using Marks = std::vector<std::atomic<bool>>;

  Session() {
    const char* text = std::getenv("LIMBER_MUTANT");
    chosen_ = text == nullptr ? -1 : std::atoi(text);
    recording_ = std::getenv("LIMBER_MUTANTS_REACHED") != nullptr;
  }
  static void write(const char* variable, const Marks& marks) {
    const char* path = std::getenv(variable);
    if (path == nullptr) return;
    std::ofstream file(path);
    for (std::size_t n = 0; n < marks.size(); ++n) {
      if (marks[n]) file << n << '\n';
    }
  }

  int chosen_ = -1;
  bool recording_ = false;
  Marks listed_ = Marks(kMost);
  Marks reached_ = Marks(kMost);
};

/// Before main(), once for each mutant in the program.
template <int N>
inline const bool listed = Session::get().list(N);
inline void keep(const bool& /*variable*/) {}

template <int N>
bool lives() {
  keep(listed<N>);
  return Session::get().lives(N);
}
/// Is mutant N chosen?
template <int N>
constexpr bool on() {
  return std::is_constant_evaluated() ? false : lives<N>();
}

// Operators that <functional> does not have.
struct ShiftLeft {
  constexpr auto operator()(auto&& a, auto&& b) const -> decltype(a << b) { return a << b; }
};
struct ShiftRight {
  constexpr auto operator()(auto&& a, auto&& b) const -> decltype(a >> b) { return a >> b; }
};

struct AddTo {
  constexpr void operator()(auto&& a, const auto& b) const { a += b; }
};
struct TakeFrom {
  constexpr void operator()(auto&& a, const auto& b) const { a -= b; }
};
struct MultiplyBy {
  constexpr void operator()(auto&& a, const auto& b) const { a *= b; }
};
struct DivideBy {
  constexpr void operator()(auto&& a, const auto& b) const { a /= b; }
};
struct SetBits {
  constexpr void operator()(auto&& a, const auto& b) const { a |= b; }
};
struct MaskBits {
  constexpr void operator()(auto&& a, const auto& b) const { a &= b; }
};

/// a and b joined by Op; mutants N, N + 1, ...: by the others.
template <int N, class Op, class... Others>
struct Binary {
  template <class A, class B>
  static constexpr decltype(auto) of(A&& a, B&& b) {
    using Result = decltype(Op{}(std::forward<A>(a), std::forward<B>(b)));
    if constexpr (std::is_arithmetic_v<Result>) {
      return choose<N, Result, Others...>(a, b);
    } else {
      return Op{}(std::forward<A>(a), std::forward<B>(b));
    }
  }

 private:
  template <int M, class Result>
  static constexpr Result choose(auto& a, auto& b) {
    return Op{}(a, b);
  }
  template <int M, class Result, class Other, class... Rest>
  static constexpr Result choose(auto& a, auto& b) {
    if constexpr (requires { Other{}(a, b); }) {
      if (on<M>()) return static_cast<Result>(Other{}(a, b));
    }
    return choose<M + 1, Result, Rest...>(a, b);
  }
};

/// a Op= b as a statement; mutant N: by Other.
template <int N, class Op, class Other>
constexpr void assign(auto&& a, const auto& b) {
  if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(a)>>) {
    if (on<N>()) {
      Other{}(a, b);
      return;
    }
  }
  Op{}(a, b);
}

/// !condition, or the condition itself where it is tested; mutant N: the opposite.
template <int N>
constexpr bool negated(const auto& condition) {
  return on<N>() != !static_cast<bool>(condition);
}
template <int N>
constexpr bool tested(const auto& condition) {
  return on<N>() != static_cast<bool>(condition);
}
/// One side of && or ||; mutant N: left out.
template <int N>
constexpr bool side_of_and(const auto& side) {
  return static_cast<bool>(side) || on<N>();
}
template <int N>
constexpr bool side_of_or(const auto& side) {
  return static_cast<bool>(side) && !on<N>();
}
/// -x; mutant N: x.
template <int N, class T>
constexpr auto minus(const T& x) {
  if constexpr (std::is_arithmetic_v<T>) {
    return on<N>() ? +x : -x;
  } else {
    return -x;
  }
}

template <class T>
concept Scalar = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Mutant N: the next integer or enumerator, the other bool, 10 % more. Mutant N + 1: the integer
/// before, or the other sign.
template <int N, bool kTwo, Scalar T>
T changed(T x) {
  if constexpr (std::is_enum_v<T>) {
    return lives<N>() ? static_cast<T>(static_cast<std::underlying_type_t<T>>(x) + 1) : x;
  } else if constexpr (std::is_same_v<T, bool>) {
    return lives<N>() != x;
  } else {
    constexpr bool whole = std::is_integral_v<T>;
    if constexpr (kTwo) {
      if (lives<N + 1>()) return static_cast<T>(whole ? x - 1 : -x);
    }
    if (!lives<N>()) return x;
    return static_cast<T>(whole || x == T{} ? x + 1 : x * 1.1);
  }
}
template <int N, bool kTwo, class T>
requires(Scalar<T>) constexpr T constant(T x) {
  return std::is_constant_evaluated() ? x : changed<N, kTwo>(x);
}
template <int N, bool kTwo, class T>
requires(!Scalar<T>) constexpr const T& constant(const T& x) { return x; }
/// The same in a table.
template <int N, class T>
requires(Scalar<T>) T cell(T x) { return changed<N, false>(x); }
template <int N, class T>
requires(!Scalar<T>) const T& cell(const T& x) { return x; }

}  // namespace limber::mutants
