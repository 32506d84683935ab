//! `pullout pages SHARE`, hidden: writes the manual pages and shell completions of an installation.

use super::{CommandLine, DONE, Refusal};
use clap::CommandFactory;
use clap_complete::{Shell, generate_to};
use std::fs;
use std::io;
use std::path::Path;

/// Places in which shells look for completions, below `share`.
const COMPLETIONS: [(Shell, &str); 3] = [
    (Shell::Bash, "bash-completion/completions"),
    (Shell::Zsh, "zsh/site-functions"),
    (Shell::Fish, "fish/vendor_completions.d"),
];

pub(super) fn write(share: &Path) -> Result<u8, Refusal> {
    write_all(share).map_err(|error| Refusal::failed(format!("{}: {error}", share.display())))?;
    Ok(DONE)
}

fn write_all(share: &Path) -> io::Result<()> {
    let manual = share.join("man/man1");
    fs::create_dir_all(&manual)?;
    clap_mangen::generate_to(CommandLine::command(), manual)?;
    for (shell, folder) in COMPLETIONS {
        let folder = share.join(folder);
        fs::create_dir_all(&folder)?;
        let written = generate_to(
            shell,
            &mut shown(&CommandLine::command()).version(env!("CARGO_PKG_VERSION")),
            "pullout",
            &folder,
        )?;
        // bash loads the file that is called like the command
        if shell == Shell::Bash {
            fs::rename(written, folder.join("pullout"))?;
        }
    }
    Ok(())
}

/// Returns a command without its hidden parts, which completions would offer.
fn shown(command: &clap::Command) -> clap::Command {
    // names live as long as the program, which ends here
    let bare = clap::Command::new(&*command.get_name().to_owned().leak());
    let bare = command.get_about().cloned().into_iter().fold(bare, clap::Command::about);
    let arguments = command.get_arguments().filter(|argument| !argument.is_hide_set()).cloned();
    let subcommands = command.get_subcommands().filter(|subcommand| !subcommand.is_hide_set()).map(shown);
    bare.args(arguments).subcommands(subcommands)
}
