#include "lcmtypes/gains_merge.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "lcmtypes/gains_table.h"

namespace limber {
namespace {

using Message = compliance_gains_t;

// `key` is that of the row, or of one of its parts: `row.part`.
bool is_part(std::string_view key, const GainRow& row, const GainWord& part) noexcept {
  const std::string_view first = row.key;
  return key.size() > first.size() && key.starts_with(first) && key[first.size()] == '.' &&
         key.substr(first.size() + 1) == part.word;
}

bool has_parts(const GainRow& row) noexcept {
  return std::holds_alternative<std::int16_t(Message::*)[5]>(row.field);
}

bool is_key_of(std::string_view key, const GainRow& row) noexcept {
  if (!has_parts(row)) return key == row.key;
  return std::ranges::any_of(row.words, [&](const GainWord& w) { return is_part(key, row, w); });
}

template <typename T>
void copy(const T& from, T& to) noexcept {
  to = from;
}
template <typename T, std::size_t n>
void copy(const T (&from)[n], T (&to)[n]) noexcept {
  for (std::size_t i = 0; i < n; ++i) copy(from[i], to[i]);
}

void merge_parts(const Message& request, const GainRow& row, bool all, Message* present) noexcept {
  const auto& cycles = *std::get_if<std::int16_t(Message::*)[5]>(&row.field);
  for (const GainWord& word : row.words) {
    const bool named = all || std::ranges::any_of(request.named, [&](const std::string& key) {
                         return is_part(key, row, word);
                       });
    if (named) (present->*cycles)[word.value] = (request.*cycles)[word.value];
  }
}

void merge_row(const Message& request, const GainRow& row, bool all, Message* present) noexcept {
  if (has_parts(row)) return merge_parts(request, row, all, present);
  if (!all && !names_gain(request, row.key)) return;
  std::visit(
      [&](auto field) {
        if constexpr (!std::is_same_v<decltype(field), std::monostate>)
          copy(request.*field, present->*field);
      },
      row.field);
}

void merge_block(const Message& request, int first, Message* present) noexcept {
  for (int i = first; i < first + 3; ++i) {
    for (int j = 0; j < 6; ++j) present->K_x[i][j] = present->K_x[j][i] = 0.0;
  }
  for (int i = first; i < first + 3; ++i) {
    for (int j = first; j < first + 3; ++j) present->K_x[i][j] = request.K_x[i][j];
  }
}

}  // namespace

bool names_gain(const Message& request, std::string_view key) noexcept {
  return std::ranges::find(request.named, key) != request.named.end();
}

void merge_gains(const Message& request, Message* present) noexcept {
  present->num_joints = request.num_joints;
  const bool all = request.scope == Message::SCOPE_ALL;
  for (const GainRow& row : gain_table()) merge_row(request, row, all, present);
  if (all) return;
  if (names_gain(request, translation_stiffness_row().key)) merge_block(request, 0, present);
  if (names_gain(request, rotation_stiffness_row().key)) merge_block(request, 3, present);
}

const char* unknown_gain(const Message& request) noexcept {
  for (const std::string& key : request.named) {
    const bool known =
        key == translation_stiffness_row().key || key == rotation_stiffness_row().key ||
        std::ranges::any_of(gain_table(), [&](const GainRow& r) { return is_key_of(key, r); });
    if (!known) return key.c_str();
  }
  return nullptr;
}

void name_gain(const char* key, Message* request) {
  if (names_gain(*request, key)) return;
  request->named.emplace_back(key);
  request->num_named = static_cast<std::int8_t>(request->named.size());
}

std::string part_key(const char* key, const char* part) { return std::string(key) + "." + part; }

}  // namespace limber
