#include "app/command_line.h"
#include "view/open_window.h"

int main(int argc, char** argv) {
  return raio::core::app::run_command_line(argc, argv, raio::core::view::open_window);
}
