#include "app/cli/command_line.h"
#include "app/views/study_chart.h"
#include "app/views/window.h"

int main(int argc, char** argv) {
  return lumifield::run_command_line(argc, argv, lumifield::run_window, lumifield::write_study_chart);
}
