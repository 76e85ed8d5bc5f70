// tessera-edit: changes a scene while it is served, and follows what others change.
#include <csignal>

#include "client/edit/command_line.h"
#include "client/edit/edit_run.h"

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);  // a reader that leaves ends the program through the failed write
    const tessera::EditCommandLine line = tessera::read_edit_command_line(argc, argv);
    return line.go_on ? tessera::run_edits(line.options) : line.exit_code;
}
