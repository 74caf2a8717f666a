#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace lumifield::test {

/// A CSV of numbers whose first line names the columns, as the tests' own tools read it.
inline std::map<std::string, std::vector<double>> read_csv_table(const std::string& file) {
  std::ifstream stream(file);
  std::string line, field;
  if (!std::getline(stream, line)) throw std::runtime_error("cannot read " + file);
  std::vector<std::string> names;
  for (std::istringstream head(line); std::getline(head, field, ',');) names.push_back(field);
  std::map<std::string, std::vector<double>> table;
  while (std::getline(stream, line)) {
    std::istringstream row(line);
    for (const std::string& name : names) {
      if (!std::getline(row, field, ',')) throw std::runtime_error("short line in " + file);
      table[name].push_back(std::stod(field));
    }
  }
  return table;
}

}  // namespace lumifield::test
