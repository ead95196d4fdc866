// SPDX-License-Identifier: GPL-3.0-or-later
// Flamenco 3: frames rendered by Granita, in chunks, or each in parts that are joined.  docs/manual/farm.md

const JOB_TYPE = {
    label: "Granita",
    description: "Render frames with Granita; large ones in parts over many machines",
    settings: [
        { key: "frames", type: "string", required: true, eval: "f'{C.scene.frame_start}-{C.scene.frame_end}'",
          description: "Frame range to render. Examples: '47', '1-30', '3, 5-10, 47-327'" },
        { key: "chunk_size", type: "int32", default: 1, propargs: { min: 1 },
          description: "Frames in one task. They share the start of Blender and the opening of the file",
          visible: "submission" },
        { key: "parts", type: "int32", default: 1, propargs: { min: 1, max: 64 },
          description: "Parts of each frame that are rendered by themselves, then joined. 1: frames stay whole",
          visible: "submission" },
        { key: "device", type: "string", default: "cpu", choices: ["cpu", "gpu", "auto"], visible: "submission",
          description: "What renders" },
        { key: "render_output_root", type: "string", subtype: "dir_path", required: true, visible: "submission",
          description: "Folder of the pictures" },
        { key: "add_path_components", type: "int32", required: true, default: 0, propargs: { min: 0, max: 32 },
          visible: "submission", description: "Folders of the file's path that are put into the output's" },
        { key: "render_output_path", type: "string", subtype: "file_path", editable: false,
          eval: "str(Path(abspath(settings.render_output_root), last_n_dir_parts(settings.add_path_components), jobname, '######'))",
          description: "Path of the pictures" },
        { key: "blendfile", type: "string", required: true, visible: "web", description: "The file to render",
          eval: "bpy.data.filepath" },
        { key: "format", type: "string", required: true, eval: "C.scene.render.image_settings.file_format",
          visible: "web" },
        { key: "image_file_extension", type: "string", required: true, eval: "C.scene.render.file_extension",
          visible: "hidden" },
    ],
};

const MOVIES = ["FFMPEG", "AVI_RAW", "AVI_JPEG", "MKV"];

function compileJob(job) {
    const settings = job.settings;
    if (MOVIES.indexOf(settings.format) >= 0) {
        throw new Error(`Granita renders frames, not movies: choose an image format instead of ${settings.format}`);
    }
    if (settings.parts > 1) {
        compileParts(job, settings);
        return;
    }
    for (const chunk of frameChunker(settings.frames, settings.chunk_size)) {
        const task = author.Task(`render-${chunk}`, "blender");
        task.addCommand(blender(settings, frames(chunk), []));
        job.addTask(task);
    }
}

/** Each frame is joined as soon as its own parts are there. */
function compileParts(job, settings) {
    for (const frame of frameChunker(settings.frames, 1)) {
        const merge = author.Task(`merge-${frame}`, "blender");
        merge.addCommand(blender(settings, frames(frame), ["--granita-merge", `${settings.parts}`]));
        for (let part = 1; part <= settings.parts; part++) {
            const task = author.Task(`part-${frame}-${part}-of-${settings.parts}`, "blender");
            const which = ["--granita-part", `${part}/${settings.parts}`];
            task.addCommand(blender(settings, frames(frame), which));
            job.addTask(task);
            merge.addDependency(task);
        }
        job.addTask(merge);
    }
}

/** Blender's own list of frames: "3,5..10". */
function frames(chunk) {
    return ["--render-frame", chunk.replace(/-/g, "..")];
}

function blender(settings, which, options) {
    return author.Command("blender-render", {
        exe: "{blender}",
        exeArgs: "{blenderArgs}",
        argsBefore: [],
        blendfile: settings.blendfile,
        args: ["--engine", "GRANITA", "--render-output", settings.render_output_path,
               "--render-format", settings.format].concat(which)
            .concat(["--", "--granita-device", settings.device]).concat(options),
    });
}
